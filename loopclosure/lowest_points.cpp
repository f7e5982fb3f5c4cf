#include "loopclosure/lowest_points.hpp"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

namespace groundloop {
namespace {

constexpr int kSteps = 20;
constexpr double kStopStep = 1e-3;  // m and rad

std::vector<Eigen::Vector3d> lowest_points(const Points& points, double cell_size) {
  std::map<std::pair<long, long>, Eigen::Vector3d> lowest;
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite() || point.z() >= 0.0F) continue;
    const Eigen::Vector3d p = point.cast<double>();
    const std::pair<long, long> cell{std::lround(std::floor(p.x() / cell_size)),
                                     std::lround(std::floor(p.y() / cell_size))};
    const auto [it, is_new] = lowest.try_emplace(cell, p);
    if (!is_new && p.z() < it->second.z()) it->second = p;
  }
  std::vector<Eigen::Vector3d> result;
  for (const auto& [cell, p] : lowest) result.push_back(p);
  return result;
}

}  // namespace

GroundAlignment plane_of_lowest_points(const Points& map_points,
                                       const GroundAlignmentOptions& options) {
  std::vector<Eigen::Vector3d> points = lowest_points(map_points, options.cell_size);
  GroundAlignment result;
  if (points.size() < 3) return result;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    result.ground_cells = 0;
    for (const Eigen::Vector3d& p : points) {
      if (std::abs(p.z()) > options.cell_size) continue;
      const Eigen::Vector3d J(1.0, p.y(), -p.x());
      H += J * J.transpose();
      b += J * p.z();
      ++result.ground_cells;
    }
    const Eigen::Vector3d x = -Eigen::LDLT<Eigen::Matrix3d>(H).solve(b);
    if (result.ground_cells < 3 || !x.allFinite()) break;
    Vector6d twist = Vector6d::Zero();
    twist.segment<3>(2) = x;
    const Pose T = exp_se3(twist);
    for (Eigen::Vector3d& p : points) p = T * p;
    result.T_ground_map = T * result.T_ground_map;
    result.found = true;
    if (x.norm() < kStopStep) break;
  }
  result.quality = static_cast<double>(result.ground_cells) / static_cast<double>(points.size());
  return result;
}

}  // namespace groundloop
