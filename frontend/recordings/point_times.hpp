// What the times of points mean. They come under several names, in several units, from several
// zeros, in fields that no file describes; what they are is judged once from several scans, said
// with the evidence, and then applied to every scan.
//
// The evidence: how long a scan would last in a unit, against the interval of the scans; how fast
// the field runs from scan to scan, against the stamps; where its values lie. A point whose time
// cannot be of the scan that the others make is dropped, whatever its value is: one wild time would
// move the sweep's middle, and with it the scan.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frontend/core/scan.hpp"
#include "frontend/recordings/point_layout.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// How a time field becomes seconds from the scan's stamp.
struct TimeModel {
  enum class Zero {
    stamp,       ///< values count from the scan's stamp
    epoch,       ///< values are of the stamps' clock
    first_point  ///< a clock of its own; the scan's first point is taken to be at the stamp
  };
  std::string field;
  FieldType type = FieldType::float32;
  double seconds_per_unit = 1.0;
  std::string unit;  ///< "s", "ms", "us", "ns", "share of the scan"
  Zero zero = Zero::stamp;
  /// A scan's points lie within so many seconds of each other.
  double longest_scan_s = 60.0;
  std::string evidence;
  bool plausible = true;  ///< false where scans would last as no scan does
  /// E.g. "field 't' (uint32), ns from the stamp; scans last 0.0999 s".
  [[nodiscard]] std::string described() const;
};

/// The time field of a layout: t, time, timestamp, time_stamp, timestamps, offset_time, time_offset
/// and alike; null where there is none.
[[nodiscard]] const PointField* find_time_field(const PointLayout& layout);

/// The time field of one scan, summarised.
struct TimeSample {
  std::string field;
  FieldType type = FieldType::float32;
  Nanoseconds stamp = 0;
  double begin = 0.0, span = 0.0;  ///< of the bulk of the points, units of the field
  std::size_t points = 0, wild = 0;
};
/// Nothing where there is no time field, or fewer than two valid points. Throws InputError
/// beginning with `where` as decode_points does.
[[nodiscard]] std::optional<TimeSample> sample_times(const PointLayout& layout,
                                                     std::span<const std::byte> data,
                                                     std::size_t count, Nanoseconds stamp,
                                                     const std::string& where);

/// What is known beside the samples.
struct TimeHints {
  Nanoseconds duration = 100'000'000;  ///< of a scan, by the stamps
  bool stamps_known = true;            ///< false where they were assumed
  std::string unit;                    ///< asked for: "ns", "us", "ms", "s"; empty: judged
};
/// Nothing where there is no sample or the field is constant in all of them. Throws InputError
/// where the unit asked for is none.
[[nodiscard]] std::optional<TimeModel> judge_times(const std::vector<TimeSample>& samples,
                                                   const TimeHints& hints);

/// What a reader does when it opens: samples of several scans gathered, then judged.
class TimeSurvey {
 public:
  /// Throws InputError as sample_times does.
  void add(const PointLayout& layout, std::span<const std::byte> data, std::size_t count,
           Nanoseconds stamp, const std::string& where);
  /// judge_times, said in info.point_times and, where points are dropped, in a note.
  [[nodiscard]] std::optional<TimeModel> finish(const TimeHints& hints, RecordingInfo& info) const;

 private:
  bool has_field_ = false;
  std::vector<TimeSample> samples_;
};

/// The times of one scan that belong together, relative to the first valid one, units of the field.
struct TimeWindow {
  double begin = 0.0, end = 0.0;  ///< of the bulk
};
/// Of values in any order, which are sorted; they must not be empty.
[[nodiscard]] TimeWindow bulk_of(std::vector<double>& values);

}  // namespace groundloop::recordings
