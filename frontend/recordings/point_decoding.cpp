// decode_points: records into a scan.
#include <cmath>
#include <type_traits>

#include "frontend/core/error.hpp"
#include "frontend/recordings/attribute_fields.hpp"
#include "frontend/recordings/point_columns.hpp"
#include "frontend/recordings/point_times.hpp"

namespace groundloop::recordings {

namespace {

// Seconds from the stamp of the value `base` of the stamps' clock, to the nanosecond where values
// are whole numbers.
template <typename T>
double seconds_after_stamp(T base, double seconds_per_unit, Nanoseconds stamp) {
  const double units_ns = seconds_per_unit * 1e9;
  if constexpr (std::is_integral_v<T>) {
    const auto unit = static_cast<std::int64_t>(std::llround(units_ns));
    std::int64_t base_ns = 0, offset_ns = 0;
    if (!__builtin_mul_overflow(static_cast<std::int64_t>(base), unit, &base_ns) &&
        !__builtin_sub_overflow(base_ns, stamp, &offset_ns))
      return 1e-9 * static_cast<double>(offset_ns);
  }
  return static_cast<double>(base) * seconds_per_unit - 1e-9 * static_cast<double>(stamp);
}

// A time further from its scan's stamp than this is none of it (s).
constexpr double kFarthest = 60.0;

// The times of one scan: those of [begin, end] from `base` are of the scan, and `shift` brings them
// to seconds from the stamp.
template <typename T>
struct ScanTimes {
  Column values;
  T base{};
  double begin = 0.0, end = -1.0;  // nothing is within
  double seconds_per_unit = 1.0;
  double shift = 0.0;

  // False where value i is not of the scan.
  bool at(std::size_t i, float& seconds) const {
    const T value = values.at<T>(i);
    const double offset = difference(value, base);
    if (!(offset >= begin && offset <= end)) return false;
    const double from_stamp = offset * seconds_per_unit + shift;
    seconds = static_cast<float>(from_stamp);
    return std::abs(from_stamp) < kFarthest;
  }
};

template <typename T>
ScanTimes<T> times_of_scan(const TimeModel& model, const Coordinates& points, const Column& values,
                           std::size_t count, Nanoseconds stamp) {
  // A thousand points tell where the bulk is.
  const std::size_t stride = std::max<std::size_t>(count / 1024, 1);
  ScanTimes<T> times{values, T{}, 0.0, -1.0, model.seconds_per_unit, 0.0};
  std::vector<double> sample;
  for (std::size_t i = 0; i < count; i += stride) {
    const T value = values.at<T>(i);
    if constexpr (!std::is_integral_v<T>) {
      if (!std::isfinite(value)) continue;
    }
    if (!is_valid(points, i)) continue;
    if (sample.empty()) times.base = value;
    sample.push_back(difference(value, times.base));
  }
  if (sample.empty()) return times;
  const TimeWindow bulk = bulk_of(sample);
  const double longest =
      std::max(model.longest_scan_s / model.seconds_per_unit, bulk.end - bulk.begin);
  times.begin = bulk.end - longest;
  times.end = bulk.begin + longest;
  if (model.zero == TimeModel::Zero::stamp) {
    times.shift = static_cast<double>(times.base) * model.seconds_per_unit;
  } else if (model.zero == TimeModel::Zero::epoch) {
    times.shift = seconds_after_stamp(times.base, model.seconds_per_unit, stamp);
  } else {
    double first = bulk.begin;
    for (std::size_t i = 0; i < count; ++i) {
      const double offset = difference(values.at<T>(i), times.base);
      if (offset >= times.begin && offset < first && is_valid(points, i)) first = offset;
    }
    times.shift = -first * model.seconds_per_unit;
  }
  return times;
}

struct NoTimes {
  static bool at(std::size_t, float&) { return true; }
};

template <typename P, typename Times>
void decode(const Coordinates& points, const Times& times, std::size_t count, bool number_records,
            Scan& scan, std::vector<std::uint32_t>& records) {
  constexpr bool kTimed = !std::is_same_v<Times, NoTimes>;
  scan.points.resize(count);
  if constexpr (kTimed) scan.times.resize(count);
  if (number_records) records.resize(count);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!load_point<P>(points, i, scan.points[kept])) continue;
    if constexpr (kTimed) {
      if (!times.at(i, scan.times[kept])) continue;
    }
    if (number_records) records[kept] = static_cast<std::uint32_t>(i);
    ++kept;
  }
  scan.points.resize(kept);
  if constexpr (kTimed) scan.times.resize(kept);
  if (number_records) records.resize(kept);
}

}  // namespace

Scan decode_points(const PointLayout& layout, std::span<const std::byte> data, std::size_t count,
                   Nanoseconds stamp, const DecodeRequest& request, const std::string& where) {
  Scan scan;
  scan.stamp = stamp;
  const Coordinates points = coordinates(layout, data, count, where);
  const bool single = points.type == FieldType::float32;
  const bool number_records = request.records != nullptr || request.attributes.any();
  std::vector<std::uint32_t> own;
  std::vector<std::uint32_t>& records = request.records != nullptr ? *request.records : own;
  if (request.times == nullptr) {
    single ? decode<float>(points, NoTimes{}, count, number_records, scan, records)
           : decode<double>(points, NoTimes{}, count, number_records, scan, records);
  } else {
    const TimeModel& model = *request.times;
    const PointField* field = layout.find(model.field);
    if (field == nullptr || field->type != model.type) {
      throw InputError(where + ": points have no time field '" + model.field + "' of type " +
                       to_string(model.type) + ", which the recording's first scans have");
    }
    const Column values = column(layout, *field, data, count, where);
    dispatch(field->type, [&](auto type) {
      const auto times = times_of_scan<decltype(type)>(model, points, values, count, stamp);
      single ? decode<float>(points, times, count, number_records, scan, records)
             : decode<double>(points, times, count, number_records, scan, records);
    });
  }
  if (request.attributes.any())
    scan.attributes = read_attributes(layout, data, count, request.attributes, records, where);
  return scan;
}

}  // namespace groundloop::recordings
