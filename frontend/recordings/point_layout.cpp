#include "frontend/recordings/point_layout.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "frontend/core/error.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {

static_assert(std::endian::native == std::endian::little, "readers assume a little-endian machine");

namespace {

template <typename T>
T load(const std::byte* at, bool swap) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

// Calls f with a value of the type's C++ type.
template <typename F>
auto dispatch(FieldType type, F&& f) {
  switch (type) {
    case FieldType::int8:
      return f(std::int8_t{});
    case FieldType::uint8:
      return f(std::uint8_t{});
    case FieldType::int16:
      return f(std::int16_t{});
    case FieldType::uint16:
      return f(std::uint16_t{});
    case FieldType::int32:
      return f(std::int32_t{});
    case FieldType::uint32:
      return f(std::uint32_t{});
    case FieldType::int64:
      return f(std::int64_t{});
    case FieldType::uint64:
      return f(std::uint64_t{});
    case FieldType::float32:
      return f(float{});
    case FieldType::float64:
      break;
  }
  return f(double{});
}

bool is_float(FieldType type) { return type == FieldType::float32 || type == FieldType::float64; }

// A column of values of one type.
struct Column {
  const std::byte* begin;
  std::size_t stride;
  bool swap;
  template <typename T>
  [[nodiscard]] T at(std::size_t i) const {
    return load<T>(begin + i * stride, swap);
  }
};

struct Coordinates {
  Column x, y, z;
  FieldType type;
};

// Throws unless the field's last value ends within the data.
Column column(const PointLayout& layout, const PointField& field, std::span<const std::byte> data,
              std::size_t count, const std::string& where) {
  const std::size_t size = size_of(field.type);
  const std::size_t before = count == 0 ? 0 : count - 1;
  const bool fits = field.offset <= data.size() && size <= data.size() - field.offset &&
                    (before == 0 || (field.stride > 0 &&
                                     before <= (data.size() - field.offset - size) / field.stride));
  if (count > 0 && !fits) {
    throw InputError(where + ": " + std::to_string(data.size()) +
                     " bytes of points are too few for " + std::to_string(count) +
                     " records with field '" + field.name +
                     "'; it is cut off or its description is wrong");
  }
  return {data.data() + (count == 0 ? 0 : field.offset), field.stride, layout.big_endian};
}

Coordinates coordinates(const PointLayout& layout, std::span<const std::byte> data,
                        std::size_t count, const std::string& where) {
  std::array<const PointField*, 3> fields{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string name(1, static_cast<char>('x' + k));
    fields[k] = layout.find(name);
    if (fields[k] == nullptr) {
      std::string present;
      for (const std::string& f : layout.described()) present += (present.empty() ? "" : ", ") + f;
      throw InputError(where + ": points have no field '" + name + "'; found are " + present);
    }
    if (!is_float(fields[k]->type) || fields[k]->type != fields[0]->type) {
      throw InputError(where + ": field '" + name + "' is " + to_string(fields[k]->type) +
                       "; x, y and z must be all float32 or all float64");
    }
  }
  return {column(layout, *fields[0], data, count, where),
          column(layout, *fields[1], data, count, where),
          column(layout, *fields[2], data, count, where), fields[0]->type};
}

template <typename T>
bool load_point(const Coordinates& c, std::size_t i, Eigen::Vector3f& p) {
  p = Eigen::Vector3f(static_cast<float>(c.x.at<T>(i)), static_cast<float>(c.y.at<T>(i)),
                      static_cast<float>(c.z.at<T>(i)));
  return is_return(p.x(), p.y(), p.z());
}

bool is_valid(const Coordinates& c, std::size_t i) {
  Eigen::Vector3f p;
  return c.type == FieldType::float32 ? load_point<float>(c, i, p) : load_point<double>(c, i, p);
}

// value - zero without loss for 64-bit integers.
template <typename T>
double difference(T value, T zero) {
  if constexpr (std::is_integral_v<T>) {
    return static_cast<double>(static_cast<std::int64_t>(static_cast<std::uint64_t>(value) -
                                                         static_cast<std::uint64_t>(zero)));
  } else {
    return static_cast<double>(value) - static_cast<double>(zero);
  }
}

template <typename T>
struct TimeRange {
  T min{}, max{};
  std::size_t count = 0;
};

template <typename T>
TimeRange<T> time_range(const Coordinates& points, const Column& times, std::size_t count) {
  TimeRange<T> range;
  for (std::size_t i = 0; i < count; ++i) {
    const T t = times.at<T>(i);
    if constexpr (!std::is_integral_v<T>) {
      if (!std::isfinite(t)) continue;
    }
    if (!is_valid(points, i)) continue;
    range.min = range.count == 0 ? t : std::min(range.min, t);
    range.max = range.count == 0 ? t : std::max(range.max, t);
    ++range.count;
  }
  return range;
}

struct Unit {
  double seconds;
  const char* name;
};
constexpr std::array<Unit, 4> kUnits = {{{1.0, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}}};

// The unit in which an absolute time lies between the years 1990 and 2100; null for others.
const Unit* unit_of_epoch(double value) {
  for (const Unit& unit : kUnits) {
    const double seconds = value * unit.seconds;
    if (seconds > 6.3e8 && seconds < 4.2e9) return &unit;
  }
  return nullptr;
}

// The unit in which `span` is a scan's duration, which lies between 0.005 and 4.5 s.
const Unit& unit_of_span(double span, bool integer) {
  if (integer) return span >= 4.5e3 && span < 4.5e6 ? kUnits[2] : kUnits[3];
  if (span < 4.5) return kUnits[0];
  if (span < 4.5e3) return kUnits[1];
  return span < 4.5e6 ? kUnits[2] : kUnits[3];
}

template <typename T>
std::optional<TimeModel> infer(const PointField& field, const TimeRange<T>& range,
                               Nanoseconds stamp, Nanoseconds period) {
  if (range.count < 2 || !(range.min < range.max)) return std::nullopt;
  const double span = difference(range.max, range.min);
  const auto min = static_cast<double>(range.min), max = static_cast<double>(range.max);
  TimeModel model;
  model.field = field.name;
  model.type = field.type;
  const Unit* epoch = unit_of_epoch(min);
  // A uint32 in ns can pass for an epoch in seconds; no scan lasts that long in seconds, though.
  if (epoch != nullptr && span * epoch->seconds > 60.0) epoch = nullptr;
  const Unit& unit = epoch != nullptr ? *epoch : unit_of_span(span, !is_float(field.type));
  model.seconds_per_unit = unit.seconds;
  model.unit = unit.name;
  const double stamp_s = 1e-9 * static_cast<double>(stamp);
  const double period_s = 1e-9 * static_cast<double>(period);
  const bool near_stamp = std::abs(min * unit.seconds - stamp_s) < 2.0;
  if (epoch == nullptr && is_float(field.type) && min >= 0.0 && max <= 1.001 && max > 0.8 &&
      period_s < 0.6) {
    model.unit = "share of the scan";
    model.seconds_per_unit = period_s;
  } else if (epoch != nullptr || std::abs(min * unit.seconds) > 2.0) {
    // Not within the scan: a clock of its own. It is the stamp's clock, or starts with each scan.
    model.zero = near_stamp ? TimeModel::Zero::epoch : TimeModel::Zero::first_point;
  }
  return model;
}

template <typename T>
T time_zero(const TimeModel& model, const Coordinates& points, const Column& times,
            std::size_t count, Nanoseconds stamp, double& remainder_s) {
  remainder_s = 0.0;
  if (model.zero == TimeModel::Zero::stamp) return T{};
  if (model.zero == TimeModel::Zero::first_point) return time_range<T>(points, times, count).min;
  const auto unit_ns = static_cast<Nanoseconds>(std::llround(model.seconds_per_unit * 1e9));
  if constexpr (std::is_integral_v<T>) {
    remainder_s = 1e-9 * static_cast<double>(stamp % unit_ns);
    return static_cast<T>(stamp / unit_ns);
  } else {
    return static_cast<T>(static_cast<double>(stamp) / static_cast<double>(unit_ns));
  }
}

constexpr double kLongestScan = 60.0;

template <typename P, typename T>
void decode(const Coordinates& points, const Column* times, const TimeModel* model,
            std::size_t count, Scan& scan) {
  scan.points.resize(count);
  double remainder = 0.0;
  T zero{};
  if (times != nullptr) {
    scan.times.resize(count);
    zero = time_zero<T>(*model, points, *times, count, scan.stamp, remainder);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!load_point<P>(points, i, scan.points[kept])) continue;
    if (times != nullptr) {
      const double offset = difference(times->at<T>(i), zero) * model->seconds_per_unit - remainder;
      if (!(std::abs(offset) < kLongestScan)) continue;
      scan.times[kept] = static_cast<float>(offset);
    }
    ++kept;
  }
  scan.points.resize(kept);
  if (times != nullptr) scan.times.resize(kept);
}

}  // namespace

std::size_t size_of(FieldType type) {
  return dispatch(type, [](auto value) { return sizeof(value); });
}

const char* to_string(FieldType type) {
  constexpr std::array<const char*, 10> names = {"int8",   "uint8", "int16",  "uint16",  "int32",
                                                 "uint32", "int64", "uint64", "float32", "float64"};
  return names.at(static_cast<std::size_t>(type));
}

void PointLayout::append(std::string name, FieldType type, std::size_t count) {
  fields.push_back({std::move(name), type, packed_size, 0});
  packed_size += size_of(type) * count;
}

void PointLayout::set_records(std::size_t begin) {
  for (PointField& field : fields) {
    field.offset += begin;
    field.stride = packed_size;
  }
}

const PointField* PointLayout::find(const std::string& name) const {
  const auto it = std::find_if(fields.begin(), fields.end(),
                               [&](const PointField& field) { return field.name == name; });
  return it == fields.end() ? nullptr : &*it;
}

std::vector<std::string> PointLayout::described() const {
  std::vector<std::string> texts;
  for (const PointField& field : fields) texts.push_back(field.name + " " + to_string(field.type));
  return texts;
}

std::string TimeModel::described() const {
  const std::string from = zero == Zero::stamp   ? " from the stamp"
                           : zero == Zero::epoch ? ", absolute"
                                                 : " from the first point of each scan (a clock "
                                                   "other than the stamps')";
  return "field '" + field + "' (" + to_string(type) + "), " + unit + from;
}

const PointField* find_time_field(const PointLayout& layout) {
  for (const char* name :
       {"t", "time", "timestamp", "time_stamp", "timestamps", "offset_time", "time_offset",
        "time_offset_ns", "timestampns", "t_offset", "gps_time", "GpsTime", "Timestamp", "Time"}) {
    if (const PointField* field = layout.find(name)) return field;
  }
  return nullptr;
}

std::optional<TimeModel> infer_time_model(const PointLayout& layout,
                                          std::span<const std::byte> data, std::size_t count,
                                          Nanoseconds stamp, Nanoseconds period) {
  const PointField* field = find_time_field(layout);
  if (field == nullptr) return std::nullopt;
  const Coordinates points = coordinates(layout, data, count, "points");
  const Column times = column(layout, *field, data, count, "points");
  return dispatch(field->type, [&](auto value) {
    return infer(*field, time_range<decltype(value)>(points, times, count), stamp, period);
  });
}

std::optional<TimeModel> merge(const std::optional<TimeModel>& a,
                               const std::optional<TimeModel>& b) {
  if (!a) return b;
  return b && a->zero == TimeModel::Zero::stamp ? b : a;
}

Scan decode_points(const PointLayout& layout, std::span<const std::byte> data, std::size_t count,
                   Nanoseconds stamp, const std::optional<TimeModel>& times,
                   const std::string& where) {
  Scan scan;
  scan.stamp = stamp;
  const Coordinates points = coordinates(layout, data, count, where);
  const bool single = points.type == FieldType::float32;
  if (!times) {
    single ? decode<float, float>(points, nullptr, nullptr, count, scan)
           : decode<double, float>(points, nullptr, nullptr, count, scan);
    return scan;
  }
  const PointField* field = layout.find(times->field);
  if (field == nullptr || field->type != times->type) {
    throw InputError(where + ": points have no time field '" + times->field + "' of type " +
                     to_string(times->type) + ", which the recording's first scans have");
  }
  const Column column_of_times = column(layout, *field, data, count, where);
  dispatch(field->type, [&](auto value) {
    using T = decltype(value);
    single ? decode<float, T>(points, &column_of_times, &*times, count, scan)
           : decode<double, T>(points, &column_of_times, &*times, count, scan);
  });
  return scan;
}

}  // namespace groundloop::recordings
