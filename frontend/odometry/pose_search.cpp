#include "frontend/odometry/pose_search.hpp"

#include <istream>
#include <limits>
#include <ostream>

#include "frontend/core/binary_io.hpp"

namespace groundloop {
namespace {

// Weight of the newest scan in the running mean.
constexpr double kGain = 0.1;
// The wide registration only has to come near.
constexpr int kWideIterations = 50;

// Keeps the best of the poses it is shown.
class Best {
 public:
  Best(const VoxelMap& map, const Points& source, double limit)
      : map_(map), source_(source), limit_(limit) {}
  void consider(const Pose& pose) {
    const double distance = mean_distance(map_, source_, pose, limit_);
    if (distance >= distance_) return;
    distance_ = distance;
    pose_ = pose;
  }
  [[nodiscard]] double distance() const { return distance_; }
  [[nodiscard]] const Pose& pose() const { return pose_; }

 private:
  const VoxelMap& map_;
  const Points& source_;
  double limit_;
  double distance_ = std::numeric_limits<double>::infinity();
  Pose pose_;
};

}  // namespace

PoseSearch::PoseSearch(const Options& options, double voxel_size)
    : options_(options),
      voxel_size_(voxel_size),
      wide_map_(static_cast<float>(options.scale * voxel_size)) {}

Pose PoseSearch::find(const VoxelMap& map, const Points& source, const Points& map_points,
                      const std::vector<Pose>& predictions, const Pose& last,
                      const RegistrationKernel& kernel) {
  if (map.empty() || source.empty()) return predictions.front();
  Best best(map, source, voxel_size_);
  for (const Pose& pose : predictions) best.consider(pose);
  const double good = options_.poor * usual_;
  if (best.distance() < good) return best.pose();

  const SweepPoints wide{
      downsampler_(map_points, 1.5F * static_cast<float>(options_.scale * voxel_size_)), {}};
  RegistrationKernel wide_kernel = kernel;
  wide_kernel.max_iterations = kWideIterations;
  const auto register_wide = [&](const Pose& start) {
    best.consider(register_scan(wide_map_, wide, start, wide_kernel).pose);
  };
  for (const Pose& pose : predictions) register_wide(pose);
  if (best.distance() < good || options_.turn <= 0.0) return best.pose();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::Vector3d turn = sign * options_.turn * Eigen::Vector3d::Unit(axis);
      const Pose start = last * Pose(exp_so3(turn), Eigen::Vector3d::Zero());
      best.consider(start);
      register_wide(start);
    }
  }
  return best.pose();
}

void PoseSearch::learn(const VoxelMap& map, const Points& source, const Pose& registered) {
  if (map.empty() || source.empty()) return;
  const double distance = mean_distance(map, source, registered, voxel_size_);
  usual_ += (scans_ == 0 ? 1.0 : kGain) * (distance - usual_);
  ++scans_;
}

void PoseSearch::insert(const Points& map_points, const Pose& T_world_scan) {
  const auto voxel = static_cast<float>(options_.scale * voxel_size_);
  wide_map_.insert(downsampler_(map_points, 0.5F * voxel), T_world_scan);
}

void PoseSearch::remove_beyond(const Eigen::Vector3d& center, float distance) {
  wide_map_.remove_beyond(center, distance);
}

void PoseSearch::save(std::ostream& out) const {
  put(out, usual_);
  put(out, scans_);
  wide_map_.save(out);
}

void PoseSearch::load(std::istream& in) {
  get(in, usual_);
  get(in, scans_);
  wide_map_.load(in);
}

}  // namespace groundloop
