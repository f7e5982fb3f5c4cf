#include "frontend/odometry/pose_search.hpp"

#include <algorithm>
#include <istream>
#include <ostream>

#include "frontend/core/binary_io.hpp"

namespace groundloop {
namespace {

// Weight of the newest scan in the running mean, once it has settled.
constexpr double kGain = 0.05;
// So many searches in a row without a better start, and scans are taken for what they are.
constexpr std::uint64_t kPatience = 5;
// The wide registration only has to come near.
constexpr int kWideIterations = 50;
// Starts this near to each other end alike, voxels and rad.
constexpr double kSameVoxels = 0.1, kSameTurn = 0.005;

}  // namespace

PoseSearch::PoseSearch(const Options& options, double voxel_size)
    : options_(options),
      voxel_size_(voxel_size),
      wide_map_(static_cast<float>(std::max(1.0, options.scale) * voxel_size)) {}

PoseSearch::Found PoseSearch::find(const Stages& stages, const VoxelMap& map, const Points& source,
                                   const Points& map_points, const Pose& guess,
                                   const std::vector<Pose>& others, const Pose& last,
                                   const RegistrationKernel& kernel, bool doubtful) {
  Pose first = guess;
  if (doubtful) {
    double nearest = mean_distance(map, source, guess, voxel_size_);
    for (const Pose& pose : others) {
      const double d = mean_distance(map, source, pose, voxel_size_);
      if (d >= nearest) continue;
      nearest = d;
      first = pose;
    }
  }
  // Where registrations began and came to: from near there another leads to the same place.
  std::vector<Pose> visited{first, stages.coarse(first).pose};
  ScanRegistration best = stages.fine(visited.back());
  if (map.empty() || source.empty()) return {best};
  double distance = mean_distance(map, source, best.pose, voxel_size_);
  // The first scan is the measure of those after it.
  const auto poor = [&] { return scans_ > 0 && distance > options_.poor * usual_; };
  const auto seen = [&](const Pose& pose) {
    return std::any_of(visited.begin(), visited.end(), [&](const Pose& other) {
      const Pose apart = other.inverse() * pose;
      return apart.translation.norm() < kSameVoxels * voxel_size_ &&
             rotation_angle(apart.rotation) < kSameTurn;
    });
  };
  const auto attempt = [&](const Pose& start) {
    if (seen(start)) return;
    const Pose coarse = stages.coarse(start).pose;
    const bool known = seen(coarse);  // by an earlier start, not by this one, which may be right
    visited.push_back(start);
    if (known) return;
    visited.push_back(coarse);
    const ScanRegistration found = stages.fine(coarse);
    const double d = mean_distance(map, source, found.pose, voxel_size_);
    if (d * options_.better >= distance) return;
    distance = d;
    best = found;
  };
  const bool searched = poor();
  const double at_first = distance;
  if (searched) {
    const SweepPoints wide{
        downsampler_(map_points, 1.5F * static_cast<float>(options_.scale * voxel_size_)), {}};
    RegistrationKernel wide_kernel = kernel;
    wide_kernel.max_iterations = std::min(kernel.max_iterations, kWideIterations);
    const auto attempt_wide = [&](const Pose& start) {
      attempt(register_scan(wide_map_, wide, start, wide_kernel).pose);
    };
    attempt_wide(guess);
    for (const Pose& pose : others) {
      attempt(pose);
      attempt_wide(pose);
    }
    for (int axis = 0; axis < 3 && options_.turn > 0.0 && poor(); ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        const Eigen::Vector3d turn = sign * options_.turn * Eigen::Vector3d::Unit(axis);
        attempt_wide(last * Pose(exp_so3(turn), Eigen::Vector3d::Zero()));
      }
    }
  }
  const double fit = usual_ > 0.0 ? distance / usual_ : 0.0;
  ++scans_;
  usual_ += std::max(kGain, 1.0 / static_cast<double>(scans_)) * (distance - usual_);
  // Where no start has led nearer time after time, it is the scene that is unusual: the next scan
  // of it is not searched for unless it lies farther still.
  if (searched) fruitless_ = distance == at_first ? fruitless_ + 1 : 0;
  if (searched && fruitless_ >= kPatience) usual_ = std::max(usual_, distance / options_.poor);
  return {best, fit};
}

void PoseSearch::insert(const Points& map_points, const Pose& T_world_scan) {
  const auto voxel = static_cast<float>(options_.scale * voxel_size_);
  wide_map_.insert(downsampler_(map_points, 0.5F * voxel), T_world_scan);
}

void PoseSearch::clear() {
  wide_map_.clear();
  usual_ = 0.0;
  scans_ = 0;
  fruitless_ = 0;
}

void PoseSearch::remove_beyond(const Eigen::Vector3d& center, float distance) {
  wide_map_.remove_beyond(center, distance);
}

void PoseSearch::save(std::ostream& out) const {
  put(out, usual_);
  put(out, scans_);
  put(out, fruitless_);
  wide_map_.save(out);
}

void PoseSearch::load(std::istream& in) {
  get(in, usual_);
  get(in, scans_);
  get(in, fruitless_);
  wide_map_.load(in);
}

}  // namespace groundloop
