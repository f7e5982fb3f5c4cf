#include "frontend/simulation/layouts/point_cloud2_writer.hpp"

#include <cmath>

#include "frontend/core/files.hpp"

namespace groundloop::layouts {

namespace {

constexpr const char* kFrame = "lidar";
enum Datatype : std::uint8_t { kUint32 = 6, kFloat32 = 7, kFloat64 = 8 };

struct Form {
  const char* name;
  std::uint8_t datatype;
  std::uint32_t size;
};

Form form_of(TimeField times) {
  switch (times) {
    case TimeField::t_ns:
      return {"t", kUint32, 4};
    case TimeField::time_s:
      return {"time", kFloat32, 4};
    case TimeField::timestamp_s:
      break;
  }
  return {"timestamp", kFloat64, 8};
}

ByteWriter point_data(const Scan& scan, TimeField times) {
  ByteWriter data;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    data.put(p.x()).put(p.y()).put(p.z());
    if (scan.times.empty()) continue;
    const auto seconds = static_cast<double>(scan.times[i]);
    if (times == TimeField::time_s) {
      data.put(scan.times[i]);
    } else if (times == TimeField::timestamp_s) {
      data.put(1e-9 * static_cast<double>(scan.stamp) + seconds);
    } else if (seconds >= 0.0 && seconds < 4.0) {
      data.put(static_cast<std::uint32_t>(std::llround(seconds * 1e9)));
    } else {
      throw InputError("a point " + to_text(seconds) +
                       " s from its stamp does not fit a count of nanoseconds from it");
    }
  }
  return data;
}

// Writes the message's parts with the encoding's rules for numbers and strings.
template <typename Number, typename Text>
void put_cloud(ByteWriter& m, const Scan& scan, TimeField times, Number&& number, Text&& text) {
  const bool timed = !scan.times.empty();
  const Form form = form_of(times);
  const std::uint32_t step = 12 + (timed ? form.size : 0);
  const auto count = static_cast<std::uint32_t>(scan.points.size());
  text(kFrame);
  number(std::uint32_t{1});  // height
  number(count);
  number(std::uint32_t{timed ? 4U : 3U});
  const auto field = [&](const char* name, std::uint32_t offset, std::uint8_t datatype) {
    text(name);
    number(offset);
    number(datatype);
    number(std::uint32_t{1});
  };
  field("x", 0, kFloat32);
  field("y", 4, kFloat32);
  field("z", 8, kFloat32);
  if (timed) field(form.name, 12, form.datatype);
  number(std::uint8_t{0});  // little-endian
  number(step);
  number(step * count);
  const ByteWriter data = point_data(scan, times);
  number(static_cast<std::uint32_t>(data.size()));
  m.put_text(data.view());
  number(std::uint8_t{1});  // dense: no invalid points
}

}  // namespace

ByteWriter ros1_message(const Scan& scan, TimeField times, std::uint32_t sequence) {
  if (scan.stamp < 0) throw InputError("a ROS 1 bag cannot hold stamps before 1970");
  ByteWriter m;
  m.put(sequence);
  m.put(static_cast<std::uint32_t>(scan.stamp / 1'000'000'000));
  m.put(static_cast<std::uint32_t>(scan.stamp % 1'000'000'000));
  put_cloud(
      m, scan, times, [&](auto value) { m.put(value); },
      [&](const char* text) { m.put_counted<std::uint32_t>(text); });
  return m;
}

ByteWriter cdr_message(const Scan& scan, TimeField times) {
  ByteWriter m;
  m.put<std::uint8_t>(0).put<std::uint8_t>(1).put<std::uint16_t>(0);  // CDR, little-endian
  // The encapsulation's four bytes do not disturb an alignment of four, and nothing needs eight.
  const auto number = [&](auto value) { m.align(sizeof value).put(value); };
  Nanoseconds seconds = scan.stamp / 1'000'000'000, rest = scan.stamp % 1'000'000'000;
  if (rest < 0) {
    rest += 1'000'000'000;
    --seconds;
  }
  number(static_cast<std::int32_t>(seconds));
  number(static_cast<std::uint32_t>(rest));
  put_cloud(m, scan, times, number, [&](const std::string& text) {
    number(static_cast<std::uint32_t>(text.size() + 1));
    m.put_text(text).put<std::uint8_t>(0);
  });
  return m;
}

const std::string& point_cloud2_definition(bool ros1) {
  static const std::string line(80, '=');
  const auto make = [](const std::string& header) {
    return "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
           "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n" +
           line + "\nMSG: std_msgs/Header\n" + header + line +
           "\nMSG: sensor_msgs/PointField\nuint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\n"
           "uint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n"
           "string name\nuint32 offset\nuint8 datatype\nuint32 count\n";
  };
  static const std::string first = make("uint32 seq\ntime stamp\nstring frame_id\n");
  static const std::string second = make("builtin_interfaces/Time stamp\nstring frame_id\n") +
                                    line +
                                    "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
  return ros1 ? first : second;
}

}  // namespace groundloop::layouts
