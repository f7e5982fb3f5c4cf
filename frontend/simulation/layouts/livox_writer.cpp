#include "frontend/simulation/layouts/livox_writer.hpp"

#include <cmath>

#include "frontend/core/files.hpp"

namespace groundloop::layouts {

ByteWriter livox_message(const Scan& scan, std::uint32_t sequence) {
  if (scan.stamp < 0) throw InputError("a ROS 1 bag cannot hold stamps before 1970");
  const auto count = static_cast<std::uint32_t>(scan.points.size());
  ByteWriter m;
  m.put(sequence);
  m.put(static_cast<std::uint32_t>(scan.stamp / 1'000'000'000));
  m.put(static_cast<std::uint32_t>(scan.stamp % 1'000'000'000));
  m.put_counted<std::uint32_t>("livox_frame");
  m.put(static_cast<std::uint64_t>(scan.stamp));  // the zero of the points' times
  m.put(count);
  m.put<std::uint8_t>(0).put<std::uint8_t>(0).put<std::uint8_t>(0).put<std::uint8_t>(0);
  m.put(count);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const double seconds = scan.times.empty() ? 0.0 : static_cast<double>(scan.times[i]);
    if (!(seconds >= 0.0 && seconds < 4.0)) {
      throw InputError("a point " + to_text(seconds) +
                       " s from its stamp does not fit a count of nanoseconds from it");
    }
    const Eigen::Vector3f& p = scan.points[i];
    m.put(static_cast<std::uint32_t>(std::llround(seconds * 1e9)));
    m.put(p.x()).put(p.y()).put(p.z());
    m.put<std::uint8_t>(0).put<std::uint8_t>(0).put<std::uint8_t>(0);  // reflectivity, tag, line
  }
  return m;
}

const std::string& livox_definition() {
  static const std::string line(80, '=');
  static const std::string definition =
      "Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\nuint8[3] rsvd\n"
      "CustomPoint[] points\n" +
      line + "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n" + line +
      "\nMSG: livox_ros_driver/CustomPoint\nuint32 offset_time\nfloat32 x\nfloat32 y\nfloat32 z\n"
      "uint8 reflectivity\nuint8 tag\nuint8 line\n";
  return definition;
}

}  // namespace groundloop::layouts
