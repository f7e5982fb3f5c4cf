#include "frontend/recordings/point_times.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "frontend/core/error.hpp"
#include "frontend/recordings/point_columns.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::array kNames = {"t",           "time",        "timestamp",   "time_stamp",
                               "timestamps",  "offset_time", "time_offset", "time_offset_ns",
                               "timestampns", "t_offset",    "gps_time",    "GpsTime",
                               "Timestamp",   "Time"};

struct Unit {
  double seconds;
  const char* name;
};
constexpr std::array<Unit, 4> kUnits = {{{1.0, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}}};

// Longer from the stamp than this, values are of a clock of their own.
constexpr double kNearStamp = 2.0;
// Stamps before this are of a clock that starts with the recording or the sensor, where chance may
// bring values near them.
constexpr double kEpochBegins = 1e6;
// A scan that lasts this many times as long as expected stays one.
constexpr double kSlack = 1.25;
// Beyond so many times what is expected a unit that was chosen by the duration alone is none.
constexpr double kTooLong = 6.0, kTooShort = 1.0 / 30.0;

std::string text(const char* format, double a) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, a);
  return buffer.data();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<Unit> allowed_units(const std::string& asked) {
  if (asked.empty()) return {kUnits.begin(), kUnits.end()};
  for (const Unit& unit : kUnits) {
    if (asked == unit.name) return {unit};
  }
  throw InputError("--time-unit: '" + asked + "' is unknown; allowed are ns, us, ms, s");
}

// In which of the units the field runs as the stamps do; null where it does not run with them.
const Unit* running_unit(const std::vector<TimeSample>& samples, const std::vector<Unit>& units,
                         double duration) {
  const Unit* best = nullptr;
  std::size_t most = 0, pairs = 0;
  for (const Unit& unit : units) {
    std::size_t agree = 0;
    pairs = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double elapsed = 1e-9 * static_cast<double>(samples[i].stamp - samples[i - 1].stamp);
      if (elapsed <= 0.0) continue;
      ++pairs;
      const double ran = (samples[i].begin - samples[i - 1].begin) * unit.seconds;
      // Stamps may jitter by half a scan, which counts for less the longer the time between them.
      if (std::abs(ran - elapsed) < 0.1 * elapsed + 0.5 * duration) ++agree;
    }
    if (agree > most) {
      most = agree;
      best = &unit;
    }
  }
  return best != nullptr && 3 * most >= 2 * pairs ? best : nullptr;
}

double median_offset(const std::vector<TimeSample>& samples, const Unit& unit) {
  std::vector<double> offsets;
  for (const TimeSample& sample : samples)
    offsets.push_back(sample.begin * unit.seconds - 1e-9 * static_cast<double>(sample.stamp));
  return median(offsets);
}

// The unit in which values lie at the stamps, as one scan alone can show: closely where the stamps'
// clock is young, and not at all where it has just begun.
const Unit* unit_at_stamps(const std::vector<TimeSample>& samples, const std::vector<Unit>& units,
                           double span, double duration) {
  const double stamp = 1e-9 * static_cast<double>(samples.front().stamp);
  if (stamp < kNearStamp) return nullptr;
  const double near = stamp < kEpochBegins ? duration : kNearStamp;
  for (const Unit& unit : units) {
    if (std::abs(median_offset(samples, unit)) < near && span * unit.seconds < 60.0) return &unit;
  }
  return nullptr;
}

// The unit in which a scan lasts as long as scans do.
const Unit& unit_of_span(const std::vector<Unit>& units, double span, double duration) {
  const auto misfit = [&](const Unit& u) {
    return std::abs(std::log(span * u.seconds / duration));
  };
  return *std::min_element(units.begin(), units.end(),
                           [&](const Unit& a, const Unit& b) { return misfit(a) < misfit(b); });
}

bool is_share(const std::vector<TimeSample>& samples) {
  return is_float(samples.front().type) &&
         std::all_of(
             samples.begin(), samples.end(),
             [](const TimeSample& s) { return s.begin > -1e-3 && s.begin + s.span < 1.001; }) &&
         std::any_of(samples.begin(), samples.end(),
                     [](const TimeSample& s) { return s.begin + s.span > 0.8; });
}

}  // namespace

std::string TimeModel::described() const {
  const std::string from = zero == Zero::stamp   ? " from the stamp"
                           : zero == Zero::epoch ? ", absolute"
                                                 : " from the first point of each scan (a clock "
                                                   "other than the stamps')";
  return "field '" + field + "' (" + to_string(type) + "), " + unit + from +
         (evidence.empty() ? "" : "; " + evidence);
}

const PointField* find_time_field(const PointLayout& layout) { return layout.find_first(kNames); }

TimeWindow bulk_of(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
  };
  const double low = at(0.05), high = at(0.95), width = high - low;
  return {*std::lower_bound(values.begin(), values.end(), low - width),
          *(std::upper_bound(values.begin(), values.end(), high + width) - 1)};
}

std::optional<TimeSample> sample_times(const PointLayout& layout, std::span<const std::byte> data,
                                       std::size_t count, Nanoseconds stamp,
                                       const std::string& where) {
  const PointField* field = find_time_field(layout);
  if (field == nullptr) return std::nullopt;
  const Coordinates points = coordinates(layout, data, count, where);
  const Column times = column(layout, *field, data, count, where);
  return dispatch(field->type, [&](auto type) -> std::optional<TimeSample> {
    using T = decltype(type);
    std::vector<double> values;
    T base{};
    for (std::size_t i = 0; i < count; ++i) {
      const T value = times.at<T>(i);
      if constexpr (!std::is_integral_v<T>) {
        if (!std::isfinite(value)) continue;
      }
      if (!is_valid(points, i)) continue;
      if (values.empty()) base = value;
      values.push_back(difference(value, base));
    }
    if (values.size() < 2) return std::nullopt;
    TimeSample sample{field->name, field->type, stamp, 0.0, 0.0, values.size(), 0};
    const TimeWindow bulk = bulk_of(values);
    sample.begin = static_cast<double>(base) + bulk.begin;
    sample.span = bulk.end - bulk.begin;
    sample.wild = values.size() -
                  static_cast<std::size_t>(
                      std::upper_bound(values.begin(), values.end(), bulk.end + sample.span) -
                      std::lower_bound(values.begin(), values.end(), bulk.begin - sample.span));
    return sample;
  });
}

std::optional<TimeModel> judge_times(const std::vector<TimeSample>& samples,
                                     const TimeHints& hints) {
  const std::vector<Unit> units = allowed_units(hints.unit);
  std::vector<double> spans;
  for (const TimeSample& sample : samples) {
    if (sample.span > 0.0) spans.push_back(sample.span);
  }
  if (spans.empty()) return std::nullopt;
  const double span = median(spans);
  const double duration = 1e-9 * static_cast<double>(std::max<Nanoseconds>(hints.duration, 1));
  TimeModel model;
  model.field = samples.front().field;
  model.type = samples.front().type;
  const Unit* running = hints.stamps_known ? running_unit(samples, units, duration) : nullptr;
  const Unit* at_stamps =
      running != nullptr ? nullptr : unit_at_stamps(samples, units, span, duration);
  const Unit& unit = running != nullptr     ? *running
                     : at_stamps != nullptr ? *at_stamps
                                            : unit_of_span(units, span, duration);
  model.seconds_per_unit = unit.seconds;
  model.unit = unit.name;
  const double offset = median_offset(samples, unit);
  std::vector<double> begins;
  for (const TimeSample& sample : samples) begins.push_back(std::abs(sample.begin) * unit.seconds);
  if (running != nullptr || at_stamps != nullptr) {
    model.zero =
        std::abs(offset) < kNearStamp ? TimeModel::Zero::epoch : TimeModel::Zero::first_point;
  } else if (hints.unit.empty() && is_share(samples)) {
    model.unit = "share of the scan";
    model.seconds_per_unit = duration;
  } else if (median(begins) > kNearStamp) {
    model.zero = TimeModel::Zero::first_point;
  }
  const double scan = span * model.seconds_per_unit;
  model.plausible = running != nullptr || at_stamps != nullptr || !hints.unit.empty() ||
                    (scan < kTooLong * duration && scan > kTooShort * duration);
  model.longest_scan_s = kSlack * std::max(scan, duration);
  model.evidence = "scans last " + text("%.4g s so", scan);
  if (running != nullptr) model.evidence += ", and the field runs with the stamps";
  if (model.zero == TimeModel::Zero::epoch)
    model.evidence += text(", the first point %+.4g s from the stamp", offset);
  if (scan < duration * kTooShort || scan > duration * kTooLong) {
    model.evidence += text(", where %.4g s are expected: --time-unit overrules", duration);
  }
  return model;
}

void TimeSurvey::add(const PointLayout& layout, std::span<const std::byte> data, std::size_t count,
                     Nanoseconds stamp, const std::string& where) {
  has_field_ = has_field_ || find_time_field(layout) != nullptr;
  auto sample = sample_times(layout, data, count, stamp, where);
  if (!sample) return;
  // A recording has one kind of points; what another kind means is not judged with them.
  if (samples_.empty() ||
      (sample->field == samples_.front().field && sample->type == samples_.front().type))
    samples_.push_back(std::move(*sample));
}

std::optional<TimeModel> TimeSurvey::finish(const TimeHints& hints, RecordingInfo& info) const {
  std::optional<TimeModel> model = judge_times(samples_, hints);
  if (model && !model->plausible) {
    info.point_times = "none (" + model->described() + ")";
    info.warnings.push_back(
        "The times of the points are not used: in no unit do scans last as long "
        "as they should; the likeliest was: " +
        model->described() + ".");
    return std::nullopt;
  }
  info.point_times = model        ? model->described()
                     : has_field_ ? "none (the time field is constant)"
                                  : "none";
  if (!model) return model;
  std::size_t wild = 0, points = 0;
  for (const TimeSample& sample : samples_) {
    wild += sample.wild;
    points += sample.points;
  }
  if (wild > 0) {
    info.warnings.push_back(
        std::to_string(wild) + " of " + std::to_string(points) +
        " points sampled have a time that cannot be of their scan; such points are dropped.");
  }
  return model;
}

}  // namespace groundloop::recordings
