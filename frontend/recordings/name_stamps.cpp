// Stamps in the names of scan files, in the forms that data sets and recorders use.
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <functional>

#include "frontend/core/files.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;

bool all_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  if (!all_digits(text)) return std::nullopt;
  std::int64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc()) return std::nullopt;
  return value;
}

// "cloud_1583840211_83000000": seconds and nanoseconds as the last two groups.
std::optional<Nanoseconds> seconds_and_nanoseconds(std::string_view stem) {
  const std::size_t second = stem.find_last_of('_');
  if (second == std::string_view::npos || second == 0) return std::nullopt;
  const std::size_t first = stem.find_last_of('_', second - 1);
  const std::size_t begin = first == std::string_view::npos ? 0 : first + 1;
  const auto s = whole_number(stem.substr(begin, second - begin));
  const auto ns = whole_number(stem.substr(second + 1));
  // Seconds of an epoch clock; smaller numbers are more likely two counters.
  if (!s || !ns || *s < 100'000'000 || *s >= kFarthestStamp / kSecond || *ns >= kSecond)
    return std::nullopt;
  return *s * kSecond + *ns;
}

// "2021-10-26-16-21-29-468", "2011_09_26_14-02-33.123", with anything before: year to second, then
// maybe a fraction. Taken as universal time.
std::optional<Nanoseconds> date_and_time(std::string_view stem) {
  std::vector<std::string_view> groups;
  std::size_t end = stem.size();
  while (end > 0 && groups.size() < 7) {
    std::size_t begin = end;
    while (begin > 0 && stem[begin - 1] >= '0' && stem[begin - 1] <= '9') --begin;
    if (begin == end) break;
    groups.insert(groups.begin(), stem.substr(begin, end - begin));
    if (begin == 0 || std::string_view("-_:.T ").find(stem[begin - 1]) == std::string_view::npos)
      break;
    end = begin - 1;
  }
  const auto at = [&](std::size_t first) -> std::optional<Nanoseconds> {
    if (groups.size() < first + 6 || groups[first].size() != 4) return std::nullopt;
    std::array<unsigned, 6> value{};
    for (std::size_t i = 0; i < 6; ++i) {
      if (i > 0 && groups[first + i].size() != 2) return std::nullopt;
      value[i] = static_cast<unsigned>(*whole_number(groups[first + i]));
    }
    using namespace std::chrono;
    const year_month_day date{year{static_cast<int>(value[0])}, month{value[1]}, day{value[2]}};
    if (!date.ok() || value[0] < 1990 || value[0] > 2200 || value[3] > 23 || value[4] > 59 ||
        value[5] > 60)
      return std::nullopt;
    const auto seconds = sys_days{date}.time_since_epoch() + hours{value[3]} + minutes{value[4]} +
                         std::chrono::seconds{value[5]};
    return duration_cast<std::chrono::seconds>(seconds).count() * kSecond;
  };
  if (const auto whole = at(groups.size() >= 6 ? groups.size() - 6 : 0)) return whole;
  if (groups.size() < 7 || groups.back().size() > 9) return std::nullopt;
  const auto seconds = at(0);
  if (!seconds) return std::nullopt;
  Nanoseconds fraction = *whole_number(groups.back());
  for (std::size_t digits = groups.back().size(); digits < 9; ++digits) fraction *= 10;
  return *seconds + fraction;
}

// "n015-2018-07-24-11-22-45+0800__LIDAR_TOP__1532402927647951": a last number of an epoch clock in
// microseconds or nanoseconds.
std::optional<std::int64_t> trailing_stamp(std::string_view stem) {
  const std::size_t begin = stem.find_last_not_of("0123456789") + 1;
  if (stem.size() - begin < 16) return std::nullopt;
  return whole_number(stem.substr(begin));
}

// Without all endings: "123.pcd.bin" is 123.
std::string stem_of(const fs::path& file) {
  const fs::path stem = file.stem();
  return stem.extension() == ".pcd" ? stem.stem().string() : stem.string();
}

// Nanoseconds a unit of whole-number names; 0 where they count scans.
Nanoseconds unit_of_names(const std::vector<std::int64_t>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const std::int64_t first = *least, last = *most;
  // Numbers of an epoch's clock are all about as large.
  if (last >= 100'000'000'000 && first < last / 2) return 0;
  if (last >= 100'000'000'000'000'000) return 1;  // 17 and more digits: epoch in ns
  if (last >= 100'000'000'000'000) return 1'000;  // epoch in us
  if (last >= 100'000'000'000) return 1'000'000;  // epoch in ms
  if (values.size() < 2) return 0;
  // A clock that starts near zero: scans are milliseconds to seconds apart, counters are not.
  const std::int64_t step = median_period(values);
  if (step >= 1'000'000) return 1;
  if (step >= 10'000) return 1'000;
  return last >= 1'000'000'000 ? kSecond : 0;
}

}  // namespace

std::optional<std::int64_t> numeric_stem(const fs::path& file) {
  return whole_number(file.stem().native());
}

std::optional<NameStamps> stamps_from_names(std::vector<fs::path>& files) {
  NameStamps result;
  std::vector<std::int64_t> whole;
  std::size_t trailing = 0;
  std::vector<std::pair<Nanoseconds, fs::path>> stamped;
  for (const fs::path& file : files) {
    const std::string stem = stem_of(file);
    Nanoseconds stamp = 0;
    if (const auto number = whole_number(stem)) {
      whole.push_back(*number);
    } else if (const auto parts = seconds_and_nanoseconds(stem)) {
      stamped.emplace_back(*parts, file);
      result.unit = "s_ns";
    } else if (stem.find_first_not_of("0123456789.") == std::string::npos &&
               parse_seconds(stem, stamp)) {
      stamped.emplace_back(stamp, file);
      result.unit = "s";
    } else if (const auto date = date_and_time(stem)) {
      stamped.emplace_back(*date, file);
      result.unit = "date and time";
    } else if (const auto last = trailing_stamp(stem)) {
      whole.push_back(*last);
      ++trailing;
    } else {
      return std::nullopt;
    }
  }
  if (!whole.empty()) {
    // Names of two kinds are no stamps of one recording.
    if (!stamped.empty() || (trailing > 0 && trailing < whole.size())) return std::nullopt;
    const Nanoseconds unit = unit_of_names(whole);
    if (unit == 0) return std::nullopt;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      if (whole[i] > kFarthestStamp / unit) return std::nullopt;
      stamped.emplace_back(whole[i] * unit, files[i]);
    }
    result.unit = unit == 1 ? "ns" : unit == 1'000 ? "us" : unit == 1'000'000 ? "ms" : "s";
  }
  std::stable_sort(stamped.begin(), stamped.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [stamp, file] : stamped) result.stamps.push_back(stamp);
  if (std::adjacent_find(result.stamps.begin(), result.stamps.end(), std::greater_equal<>()) !=
      result.stamps.end())
    return std::nullopt;
  for (std::size_t i = 0; i < files.size(); ++i) files[i] = stamped[i].second;
  return result;
}

}  // namespace groundloop::recordings
