#include "frontend/recordings/ground_truth.hpp"

#include <charconv>
#include <cmath>
#include <limits>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/source_tools.hpp"
#include "frontend/recordings/text_table.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr Nanoseconds kNoStamp = std::numeric_limits<Nanoseconds>::max();

// "1326030975726043", exactly; also "1326030975726043.0" and "1.326030975726043e15".
std::int64_t whole_number(std::string_view text, double value) {
  std::int64_t whole = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), whole);
  const std::string_view rest = text.substr(static_cast<std::size_t>(result.ptr - text.data()));
  if (result.ec == std::errc() && rest.find_first_of("eE") == std::string_view::npos) return whole;
  return std::abs(value) < 9e18 ? std::llround(value) : kNoStamp;
}

}  // namespace

NumberTable read_numbers(const fs::path& file, bool nan_allowed) {
  const std::string text = read_text(file);
  NumberTable table;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::vector<std::string_view> words = split(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (words.empty() || words[0].front() == '#') continue;
    std::vector<double> row;
    bool has_nan = false;
    for (const std::string_view word : words) {
      double value = 0.0;
      if (nan_allowed && (word == "nan" || word == "NaN" || word == "-nan")) {
        has_nan = true;
      } else if (!parse_double(word, value)) {
        const bool heading = word.find_first_of("0123456789+-.") != 0;
        if (heading && table.rows.empty() && row.empty()) break;
        throw InputError(file.string() + ":" + std::to_string(number) + ": '" + std::string(word) +
                         "' is no finite number");
      }
      row.push_back(value);
    }
    if (row.empty()) continue;
    if (has_nan) {
      ++table.without_numbers;
      continue;
    }
    if (table.rows.empty()) table.columns = row.size();
    if (row.size() != table.columns) {
      throw InputError(file.string() + ":" + std::to_string(number) + ": " +
                       std::to_string(row.size()) + " columns, the lines before have " +
                       std::to_string(table.columns));
    }
    Nanoseconds seconds = 0;
    if (!parse_seconds(words[0], seconds)) seconds = kNoStamp;
    table.whole.push_back(whole_number(words[0], row[0]));
    table.rows.push_back(std::move(row));
    table.lines.push_back(number);
    table.seconds.push_back(seconds);
  }
  if (table.rows.empty()) throw InputError(file.string() + ": holds no line of numbers");
  return table;
}

Nanoseconds stamp_of_row(const fs::path& file, const NumberTable& table, std::size_t row,
                         Nanoseconds nanoseconds) {
  const std::int64_t value = table.whole[row];
  if (value >= -kFarthestStamp / nanoseconds && value <= kFarthestStamp / nanoseconds)
    return value * nanoseconds;
  throw InputError(file.string() + ":" + std::to_string(table.lines[row]) + ": " +
                   std::to_string(value) + " is no stamp");
}

Trajectory read_ground_truth(const fs::path& file, const std::vector<Nanoseconds>& stamps) {
  const NumberTable table = read_numbers(file);
  Trajectory trajectory;
  if (table.columns == 12) {
    const std::vector<Pose> poses = read_kitti_poses(file);
    if (poses.size() != stamps.size()) {
      throw InputError(file.string() + ": " + std::to_string(poses.size()) + " poses for " +
                       std::to_string(stamps.size()) +
                       " scans; ground truth without stamps needs one line a scan");
    }
    for (std::size_t i = 0; i < poses.size(); ++i) trajectory.push_back({stamps[i], poses[i]});
    return trajectory;
  }
  if (table.columns != 8 && table.columns != 9) {
    throw InputError(file.string() + ": " + std::to_string(table.columns) +
                     " columns; expected 8 (stamp x y z qx qy qz qw), 9 (s ns ...) or 12 (a 3x4 "
                     "matrix)");
  }
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::vector<double>& row = table.rows[i];
    StampedPose sample;
    std::size_t at = 1;
    if (table.columns == 9) {
      sample.stamp = stamp_of_row(file, table, i, 1'000'000'000);
      if (!(row[1] >= 0.0 && row[1] < 1e10)) {
        throw InputError(file.string() + ":" + std::to_string(table.lines[i]) + ": " +
                         to_text(row[1]) + " are no nanoseconds of a second");
      }
      sample.stamp += std::llround(row[1]);
      at = 2;
    } else {
      sample.stamp = std::abs(row[0]) > 1e12 ? stamp_of_row(file, table, i, 1) : table.seconds[i];
      if (!is_stamp(sample.stamp)) {
        throw InputError(file.string() + ":" + std::to_string(table.lines[i]) + ": " +
                         to_text(row[0]) + " is no stamp in seconds");
      }
    }
    const Eigen::Quaterniond q(row[at + 6], row[at + 3], row[at + 4], row[at + 5]);
    if (!(std::abs(q.norm() - 1.0) <= 1e-2)) {
      throw InputError(file.string() + ":" + std::to_string(table.lines[i]) +
                       ": the quaternion has norm " + to_text(q.norm()) + ", expected 1");
    }
    sample.pose = Pose(q, Eigen::Vector3d(row[at], row[at + 1], row[at + 2]));
    trajectory.push_back(sample);
  }
  return trajectory;
}

fs::path find_ground_truth(const std::vector<fs::path>& folders) {
  std::error_code error;
  for (const fs::path& folder : folders) {
    for (const char* name :
         {"ground_truth", "groundtruth", "gt", "poses", "gt_poses", "registered_poses"}) {
      for (const char* extension : {".txt", ".tum", ".csv", ".kitti"}) {
        fs::path file = folder / (std::string(name) + extension);
        if (fs::is_regular_file(file, error)) return file;
      }
    }
  }
  return {};
}

}  // namespace groundloop::recordings
