// What every reader of recordings shares: reading a file into a buffer that is used again, stamps
// from text files and file names, and what is counted about them. Formats themselves are elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// Reads a whole file into `buffer`, whose memory is used again from call to call. Throws
/// InputError naming the file.
void read_file_into(const std::filesystem::path& file, std::vector<std::byte>& buffer);

/// Nanoseconds from a text file of one stamp a line (first column, decimal seconds). Throws
/// InputError naming file and line where one is no number, or is not after the one before it.
[[nodiscard]] std::vector<Nanoseconds> read_stamp_file(const std::filesystem::path& file);

/// Stamps for `scans` scan files from a list that may be longer, and where in the list each was
/// found.
struct StampTable {
  std::vector<Nanoseconds> stamps;
  std::vector<std::size_t> rows;
};
/// Row i for scan i where the lengths agree; where the list is longer, the row that the scan file's
/// numeric name gives. Throws InputError where there are fewer stamps than scans, or names do not
/// decide.
[[nodiscard]] StampTable match_stamps(const std::vector<std::filesystem::path>& scans,
                                      const std::filesystem::path& list,
                                      const std::vector<Nanoseconds>& stamps);

/// Stamps from file names and how they were understood, e.g. "file names (ns)"; nothing where the
/// names are no stamps.
struct NameStamps {
  std::vector<Nanoseconds> stamps;
  std::string unit;
};
/// Names such as 1567496784952532897.bin (ns), 1326030975726043.bin (us), 12.25.bin (s),
/// cloud_1583840211_83000000.pcd (s_ns), 2021-10-26-16-21-29-468.pcd (date and time, UTC) and
/// any__1532402927647951.pcd.bin (a last number of 16 digits or more). Small whole numbers one
/// apart are numbers, not stamps. Sorts `files` by stamp.
[[nodiscard]] std::optional<NameStamps> stamps_from_names(
    std::vector<std::filesystem::path>& files);

/// The whole number that a file name (without extension) is, if it is one.
[[nodiscard]] std::optional<std::int64_t> numeric_stem(const std::filesystem::path& file);

/// Stamps at 10 Hz from zero: what is assumed where a recording has none.
[[nodiscard]] std::vector<Nanoseconds> assumed_stamps(std::size_t scans);

/// Up to `most` numbers spread over [0, size), the first and the last among them.
[[nodiscard]] std::vector<std::size_t> spread_indices(std::size_t size, std::size_t most = 8);

/// Median difference of successive stamps, 0.1 s where there are fewer than two.
[[nodiscard]] Nanoseconds median_period(const std::vector<Nanoseconds>& stamps);

/// How long a scan takes: the interval that a tenth of all intervals are below, since a recording
/// may hold only some of the sensor's scans; 0.1 s where that is longer than LiDARs take (0.25 s).
[[nodiscard]] Nanoseconds scan_duration(const std::vector<Nanoseconds>& stamps);

/// Intervals longer than 1.75 median ones: at least one scan is missing there.
[[nodiscard]] std::size_t count_gaps(const std::vector<Nanoseconds>& stamps);

/// A 3x4 matrix row by row as a pose. Throws InputError starting with `where` where the left block
/// is no rotation beyond 1e-3.
[[nodiscard]] Pose pose_from_matrix(const double (&rows)[12], const std::string& where);

/// Removes the points, with all that is kept of them, for which remove(i) is true; it is asked once
/// for each, in order.
template <typename F>
void remove_points(Scan& scan, F&& remove) {
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!remove(i)) kept.push_back(static_cast<std::uint32_t>(i));
  }
  if (kept.size() == scan.points.size()) return;
  const auto compact = [&](auto& list) {
    if (list.empty()) return;
    for (std::size_t k = 0; k < kept.size(); ++k) list[k] = list[kept[k]];
    list.resize(kept.size());
  };
  compact(scan.points);
  compact(scan.times);
  PointAttributes::visit(scan.attributes, compact);
}

/// Throws InputError for a scan without any valid point: `file` is named with how many were seen.
void require_points(const Scan& scan, std::size_t seen, const std::string& file);

/// True for a point a sensor can have measured: finite, and not the zero that stands for no return.
[[nodiscard]] inline bool is_return(float x, float y, float z) {
  // The sum is finite only if all terms are; squares of coordinates beyond 1e19 m overflow, too.
  const float square = x * x + y * y + z * z;
  return square > 0.0F && square < 1e30F;
}

}  // namespace groundloop::recordings
