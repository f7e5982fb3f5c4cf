#include "apps/report/point_sampler.hpp"

#include <algorithm>
#include <numbers>

#include "backend/registration/voxel_pyramid.hpp"

namespace groundloop::apps {
namespace {

float from_centre(const Eigen::Vector3f& p, const Eigen::Vector3i& voxel, float size) {
  return (p - (voxel.cast<float>().array() + 0.5F).matrix() * size).squaredNorm();
}

}  // namespace

PointSampler::PointSampler(std::size_t wanted, float finest)
    : wanted_(std::max<std::size_t>(wanted, 1)), voxel_size_(finest) {}

void PointSampler::add(const MapPoint& point) {
  if (!has_voxel(point.position)) return;
  insert(point);
  while (points_.size() > 2 * wanted_) coarsen();
}

void PointSampler::insert(const MapPoint& point) {
  const Eigen::Vector3i voxel = voxel_of(point.position, 1.0F / voxel_size_);
  const auto next = static_cast<std::uint32_t>(points_.size());
  const std::uint32_t found = table_.find_or_insert(voxel_key(voxel), next);
  if (found == next) {
    points_.push_back(point);
  } else if (from_centre(point.position, voxel, voxel_size_) <
             from_centre(points_[found].position, voxel, voxel_size_)) {
    points_[found] = point;
  }
}

void PointSampler::coarsen() {
  voxel_size_ *= std::numbers::sqrt2_v<float>;
  const std::vector<MapPoint> all = std::move(points_);
  points_.clear();
  table_.clear();
  for (const MapPoint& point : all) insert(point);
}

}  // namespace groundloop::apps
