#include "tests/benchmarks/baselines/solid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frontend/core/parallel.hpp"
#include "tests/benchmarks/baselines/voxel_means.hpp"

namespace groundloop::baselines {
namespace {

constexpr int kRanges = 40, kHeights = 32;
constexpr double kMinRange = 3.0, kMaxRange = 80.0, kVoxel = 0.4;  // m
constexpr double kDegrees = 180 / std::numbers::pi;

double elevation_deg(const Eigen::Vector3f& p) {
  return kDegrees * std::atan2(static_cast<double>(p.z()),
                               std::hypot(static_cast<double>(p.x()), static_cast<double>(p.y())));
}

std::vector<Solid> descriptors(const SessionScans& scans) {
  std::vector<Points> few;
  for (std::size_t i = 0; i < 10; ++i) few.push_back(scans.points(i * scans.size() / 10));
  const FieldOfView view = field_of_view(few);
  std::vector<Solid> result(scans.size());
  parallel_for(scans.size(), 8, [&](std::size_t i) { result[i] = solid(scans.points(i), view); });
  return result;
}

}  // namespace

FieldOfView field_of_view(const std::vector<Points>& scans) {
  std::vector<double> elevations;
  for (const Points& points : scans) {
    for (const Eigen::Vector3f& p : points) elevations.push_back(elevation_deg(p));
  }
  if (elevations.size() < 2) return {};
  std::sort(elevations.begin(), elevations.end());
  const std::size_t out = elevations.size() / 200;
  return {elevations[out], elevations[elevations.size() - 1 - out]};
}

Solid solid(const Points& points, const FieldOfView& view) {
  Points within;
  for (const Eigen::Vector3f& p : points) {
    const double range = static_cast<double>(p.norm());
    if (range > kMinRange && range < kMaxRange) within.push_back(p);
  }
  Eigen::Matrix<double, kRanges, kHeights> counts =
      Eigen::Matrix<double, kRanges, kHeights>::Zero();
  const double step = (view.up_deg - view.down_deg) / kHeights;
  for (const Eigen::Vector3f& p : voxel_means(within, kVoxel)) {
    const double flat = std::hypot(static_cast<double>(p.x()), static_cast<double>(p.y()));
    const int range = static_cast<int>(flat / (kMaxRange / kRanges));
    const int height = static_cast<int>((elevation_deg(p) - view.down_deg) / step);
    counts(std::clamp(range, 0, kRanges - 1), std::clamp(height, 0, kHeights - 1)) += 1;
  }
  Eigen::Matrix<double, kHeights, 1> weight = counts.colwise().sum().transpose();
  const double least = weight.minCoeff(), most = weight.maxCoeff();
  if (most <= least) return Solid::Zero();
  weight = (weight.array() - least) / (most - least);
  return counts * weight;
}

double solid_similarity(const Solid& a, const Solid& b) {
  const double norms = a.norm() * b.norm();
  return norms > 0 ? a.dot(b) / norms : 0.0;
}

MapPairs detect_by_solid(const SessionScans& references, const SessionScans& queries) {
  const std::vector<Solid> reference = descriptors(references);
  const bool same = &references == &queries;
  const std::vector<Solid> other = same ? std::vector<Solid>() : descriptors(queries);
  const std::vector<Solid>& query = same ? reference : other;
  MapPairs pairs;
  for (std::size_t q = 0; q < query.size(); ++q) {
    for (std::size_t r = 0; r < reference.size(); ++r) {
      if (!may_report(references, r, queries, q)) continue;
      pairs.add(references, r, queries, q, solid_similarity(query[q], reference[r]), std::nullopt);
    }
  }
  return pairs;
}

}  // namespace groundloop::baselines
