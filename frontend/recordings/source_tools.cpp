#include "frontend/recordings/source_tools.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <utility>

#include <Eigen/LU>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/unreadable_file.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;

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

}  // namespace

void read_file_into(const fs::path& file, std::vector<std::byte>& buffer) {
  const auto fail = [&](const char* what) { return UnreadableFile(file.string() + ": " + what); };
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
