#include "frontend/core/trajectory.hpp"

#include <array>
#include <charconv>
#include <sstream>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

std::vector<std::string_view> split_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t i = 0;
  while (i < line.size()) {
    while (i < line.size() &&
           (line[i] == ' ' || line[i] == '\t' || line[i] == '\r' || line[i] == ','))
      ++i;
    std::size_t end = i;
    while (end < line.size() && line[end] != ' ' && line[end] != '\t' && line[end] != '\r' &&
           line[end] != ',')
      ++end;
    if (end > i) fields.push_back(line.substr(i, end - i));
    i = end;
  }
  return fields;
}

std::string place(const fs::path& file, std::size_t line) {
  return file.string() + ":" + std::to_string(line) + ": ";
}

// Calls f(line_number, fields) for each line that is neither empty nor a comment.
template <typename F>
void for_each_record(const fs::path& file, F&& f) {
  const std::string text = read_text(file);
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::vector<std::string_view> fields = split_fields(line);
    if (fields.empty() || fields.front().front() == '#') continue;
    f(number, fields);
  }
}

template <std::size_t N>
std::array<double, N> numbers(const fs::path& file, std::size_t line,
                              const std::vector<std::string_view>& fields, std::size_t first) {
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    if (!parse_double(fields[first + i], values[i])) {
      throw InputError(place(file, line) + "'" + std::string(fields[first + i]) +
                       "' is no finite number");
    }
  }
  return values;
}

}  // namespace

double path_length(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].pose.translation - trajectory[i - 1].pose.translation).norm();
  }
  return length;
}

Trajectory read_tum(const fs::path& file) {
  Trajectory trajectory;
  for_each_record(file, [&](std::size_t line, const std::vector<std::string_view>& fields) {
    if (fields.size() != 8) {
      throw InputError(place(file, line) + std::to_string(fields.size()) +
                       " columns, a TUM trajectory has 8 (stamp tx ty tz qx qy qz qw)");
    }
    StampedPose sample;
    if (!parse_seconds(fields[0], sample.stamp)) {
      throw InputError(place(file, line) + "'" + std::string(fields[0]) +
                       "' is no stamp in seconds");
    }
    const auto v = numbers<7>(file, line, fields, 1);
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    if (std::abs(q.norm() - 1.0) > 1e-2) {
      throw InputError(place(file, line) + "the quaternion has norm " + to_text(q.norm()) +
                       ", expected 1");
    }
    sample.pose = Pose(q, Eigen::Vector3d(v[0], v[1], v[2]));
    // Our own files are kept to the last bit, so that a trajectory read and written is the same.
    if (std::abs(q.norm() - 1.0) < 1e-12) sample.pose.rotation = q;
    trajectory.push_back(sample);
  });
  if (trajectory.empty()) throw InputError(file.string() + ": holds no pose");
  return trajectory;
}

std::vector<Pose> read_kitti_poses(const fs::path& file) {
  std::vector<Pose> poses;
  for_each_record(file, [&](std::size_t line, const std::vector<std::string_view>& fields) {
    if (fields.size() != 12) {
      throw InputError(place(file, line) + std::to_string(fields.size()) +
                       " columns, a KITTI trajectory has 12 (3x4 matrix, row by row)");
    }
    const auto v = numbers<12>(file, line, fields, 0);
    Eigen::Matrix3d rotation;
    rotation << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
    if ((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() >
            1e-3 ||
        rotation.determinant() < 0.0) {
      throw InputError(place(file, line) + "the left 3x3 block is no rotation");
    }
    poses.emplace_back(rotation, Eigen::Vector3d(v[3], v[7], v[11]));
  });
  if (poses.empty()) throw InputError(file.string() + ": holds no pose");
  return poses;
}

void write_tum(const fs::path& file, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& s : trajectory) {
    const Eigen::Quaterniond& q = s.pose.rotation;
    text += seconds_text(s.stamp);
    for (const double v : {s.pose.translation.x(), s.pose.translation.y(), s.pose.translation.z(),
                           q.x(), q.y(), q.z(), q.w()}) {
      text += " " + to_text(v);
    }
    text += "\n";
  }
  write_text_atomically(file, text);
}

void write_kitti_poses(const fs::path& file, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& s : trajectory) {
    const Eigen::Matrix4d m = s.pose.matrix();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) text += (r + c == 0 ? "" : " ") + to_text(m(r, c));
    }
    text += "\n";
  }
  write_text_atomically(file, text);
}

}  // namespace groundloop
