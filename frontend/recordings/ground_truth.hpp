// Ground truth that lies beside a recording in one of the common text forms.
#pragma once

#include <filesystem>
#include <vector>

#include "frontend/core/trajectory.hpp"

namespace groundloop::recordings {

/// Rows of numbers of a text file, separated by blanks or commas; lines that begin with '#' and one
/// heading line of words are skipped. Throws InputError naming file and line, for rows of differing
/// length as well.
struct NumberTable {
  std::size_t columns = 0;
  std::vector<std::vector<double>> rows;
  std::vector<std::size_t> lines;    ///< line number of each row
  std::vector<Nanoseconds> seconds;  ///< first column read as decimal seconds, exactly
  std::vector<Nanoseconds> whole;    ///< first column read as a whole number
  std::size_t without_numbers = 0;   ///< rows left out, as they hold a NaN
};
/// With `nan_allowed`, rows that hold a NaN are left out and counted; else they are errors.
[[nodiscard]] NumberTable read_numbers(const std::filesystem::path& file, bool nan_allowed = false);

/// Column 0 of a row, a whole number of units of so many nanoseconds, as a stamp. Throws InputError
/// naming file and line where it is too far to be one.
[[nodiscard]] Nanoseconds stamp_of_row(const std::filesystem::path& file, const NumberTable& table,
                                       std::size_t row, Nanoseconds nanoseconds);

/// TUM (8 columns), TUM with seconds and nanoseconds apart (9), or KITTI (12, one row a scan,
/// stamped with `stamps`). A first column beyond 1e12 is nanoseconds. Throws InputError where the
/// rows are none of these, a quaternion or matrix is no rotation, or KITTI's length differs.
[[nodiscard]] Trajectory read_ground_truth(const std::filesystem::path& file,
                                           const std::vector<Nanoseconds>& stamps);

/// A file of a usual name (ground_truth, groundtruth, gt, poses, registered_poses with .txt, .tum,
/// .csv, .kitti) in one of the folders, in their order; empty where there is none.
[[nodiscard]] std::filesystem::path find_ground_truth(
    const std::vector<std::filesystem::path>& folders);

}  // namespace groundloop::recordings
