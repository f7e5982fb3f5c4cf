#include "frontend/recordings/source_tools.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <memory>
#include <utility>

#include <Eigen/LU>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

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

// The interval that a share of all intervals are below.
Nanoseconds interval_at(const std::vector<Nanoseconds>& stamps, double share) {
  if (stamps.size() < 2) return kSecond / 10;
  std::vector<Nanoseconds> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(steps.size()));
  std::nth_element(steps.begin(), steps.begin() + rank, steps.end());
  return steps[static_cast<std::size_t>(rank)];
}

bool strictly_increasing(const std::vector<Nanoseconds>& stamps) {
  return std::adjacent_find(stamps.begin(), stamps.end(), std::greater_equal<>()) == stamps.end();
}

// Nanoseconds a unit of whole-number names; 0 where they count scans.
Nanoseconds unit_of_names(const std::vector<std::int64_t>& values) {
  const std::int64_t last = *std::max_element(values.begin(), values.end());
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

void read_file_into(const fs::path& file, std::vector<std::byte>& buffer) {
  const auto fail = [&](const char* what) -> InputError {
    return InputError(file.string() + ": " + what);
  };
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw fail("cannot be read; check that it exists and is a file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(file.c_str(), "rb"),
                                                           &std::fclose);
  if (!in) throw fail("cannot be opened; check its permissions");
  std::setvbuf(in.get(), nullptr, _IONBF, 0);
  buffer.resize(size);
  if (std::fread(buffer.data(), 1, size, in.get()) != size) {
    throw fail("ended before its length; is it still being written?");
  }
}

std::vector<Nanoseconds> read_stamp_file(const fs::path& file) {
  const std::string text = read_text(file);
  std::vector<Nanoseconds> stamps;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || line[begin] == '#') continue;
    line.remove_prefix(begin);
    line = line.substr(0, line.find_first_of(" \t\r,"));
    const std::string where = file.string() + ":" + std::to_string(number) + ": ";
    Nanoseconds stamp = 0;
    if (!parse_seconds(line, stamp)) {
      throw InputError(where + "'" + std::string(line) +
                       "' is no stamp; expected seconds, one scan a line");
    }
    if (!stamps.empty() && stamp <= stamps.back()) {
      throw InputError(where + "stamp " + seconds_text(stamp) +
                       (stamp == stamps.back() ? " stands still" : " goes back") + " after " +
                       seconds_text(stamps.back()) + "; stamps must increase from line to line");
    }
    stamps.push_back(stamp);
  }
  return stamps;
}

StampTable match_stamps(const std::vector<fs::path>& scans, const fs::path& list,
                        const std::vector<Nanoseconds>& stamps) {
  StampTable table;
  if (stamps.size() < scans.size()) {
    throw InputError(list.string() + ": " + std::to_string(stamps.size()) + " stamps for " +
                     std::to_string(scans.size()) + " scans; it needs one line a scan");
  }
  for (std::size_t i = 0; i < scans.size(); ++i) {
    std::size_t row = i;
    if (stamps.size() != scans.size()) {
      const auto number = numeric_stem(scans[i]);
      if (!number || static_cast<std::size_t>(*number) >= stamps.size()) {
        throw InputError(list.string() + ": " + std::to_string(stamps.size()) + " stamps for " +
                         std::to_string(scans.size()) + " scans, and " +
                         scans[i].filename().string() +
                         " names none of them; it needs one line a scan");
      }
      row = static_cast<std::size_t>(*number);
    }
    table.rows.push_back(row);
    table.stamps.push_back(stamps[row]);
  }
  if (!strictly_increasing(table.stamps)) {
    throw InputError(list.string() + ": two scan files have the same number; rename one");
  }
  return table;
}

std::optional<std::int64_t> numeric_stem(const fs::path& file) {
  return whole_number(file.stem().native());
}

std::optional<NameStamps> stamps_from_names(std::vector<fs::path>& files) {
  NameStamps result;
  std::vector<std::int64_t> whole;
  std::vector<std::pair<Nanoseconds, fs::path>> stamped;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
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
    } else {
      return std::nullopt;
    }
  }
  if (!whole.empty()) {
    if (!stamped.empty()) return std::nullopt;  // two kinds of names
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
  if (!strictly_increasing(result.stamps)) return std::nullopt;
  for (std::size_t i = 0; i < files.size(); ++i) files[i] = stamped[i].second;
  return result;
}

std::vector<Nanoseconds> assumed_stamps(std::size_t scans) {
  std::vector<Nanoseconds> stamps(scans);
  for (std::size_t i = 0; i < scans; ++i) stamps[i] = static_cast<Nanoseconds>(i) * (kSecond / 10);
  return stamps;
}

std::vector<std::size_t> spread_indices(std::size_t size, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t count = std::min(size, most);
  for (std::size_t k = 0; k < count; ++k)
    indices.push_back(count == 1 ? 0 : k * (size - 1) / (count - 1));
  return indices;
}

Nanoseconds median_period(const std::vector<Nanoseconds>& stamps) {
  return interval_at(stamps, 0.5);
}

Nanoseconds scan_duration(const std::vector<Nanoseconds>& stamps) {
  const Nanoseconds interval = interval_at(stamps, 0.1);
  return interval > kSecond / 4 ? kSecond / 10 : interval;
}

std::size_t count_gaps(const std::vector<Nanoseconds>& stamps) {
  const double limit = 1.75 * static_cast<double>(median_period(stamps));
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (static_cast<double>(stamps[i] - stamps[i - 1]) > limit) ++gaps;
  }
  return gaps;
}

Pose pose_from_matrix(const double (&rows)[12], const std::string& where) {
  Eigen::Matrix3d rotation;
  rotation << rows[0], rows[1], rows[2], rows[4], rows[5], rows[6], rows[8], rows[9], rows[10];
  const double error =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= 1e-3) || rotation.determinant() < 0.0) {
    throw InputError(where + "the left 3x3 block is no rotation");
  }
  return {rotation, Eigen::Vector3d(rows[3], rows[7], rows[11])};
}

void require_points(const Scan& scan, std::size_t seen, const std::string& file) {
  if (!scan.points.empty()) return;
  if (seen == 0) throw InputError(file + ": holds no point; remove the scan or record it anew");
  throw InputError(
      file + ": none of its " + std::to_string(seen) +
      " points is valid (all NaN, infinite or zero); remove the scan or record it anew");
}

}  // namespace groundloop::recordings
