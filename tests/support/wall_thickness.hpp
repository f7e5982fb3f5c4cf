// How thick the flat walls of a simulated recording come out when its scans are put together with
// ground truth: the measure of deskewing and of range noise.
#pragma once

#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include <Eigen/Eigenvalues>

#include "frontend/simulation/simulation.hpp"

namespace groundloop::testing {

struct WallThickness {
  double rms = 0.0;  ///< of the distances from each wall's own plane, m
  std::size_t walls = 0, points = 0;
};

/// Scans first, first + step, ... (count of them), each point placed by the pose of its own time
/// (deskew) or of its scan's start. Walls are upright faces of the world with at least 40 points
/// whose places at their own times vary by more than 0.1 m^2 in two directions.
inline WallThickness wall_thickness(SimulatedRecording& recording, std::size_t first,
                                    std::size_t count, std::size_t step, bool deskew) {
  struct Face {
    std::vector<Eigen::Vector3d> own, placed;  // by the pose of the point's time, and as asked
  };
  const auto variances = [](const std::vector<Eigen::Vector3d>& points) -> Eigen::Vector3d {
    const auto n = static_cast<double>(points.size());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) mean += p / n;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : points) scatter += (p - mean) * (p - mean).transpose() / n;
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
  };
  std::map<std::uint64_t, Face> faces;
  std::vector<PointTruth> truth;
  for (std::size_t k = 0; k < count && first + k * step < recording.size(); ++k) {
    const Scan scan = recording.read_with_truth(first + k * step, truth);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (truth[i].moving || !truth[i].true_echo || std::abs(truth[i].normal.z()) > 0.1F) continue;
      const Eigen::Vector3d p = scan.points[i].cast<double>();
      const auto offset = std::llround(1e9 * static_cast<double>(scan.times[i]));
      Face& face = faces[truth[i].surface];
      face.own.push_back(recording.pose_at(scan.stamp + offset) * p);
      face.placed.push_back(deskew ? face.own.back() : recording.pose_at(scan.stamp) * p);
    }
  }
  WallThickness result;
  double sum = 0.0;
  for (const auto& [surface, face] : faces) {
    if (face.own.size() < 40 || variances(face.own)(1) < 0.1) continue;
    sum += static_cast<double>(face.own.size()) * std::max(0.0, variances(face.placed)(0));
    result.points += face.own.size();
    ++result.walls;
  }
  if (result.points > 0) result.rms = std::sqrt(sum / static_cast<double>(result.points));
  return result;
}

}  // namespace groundloop::testing
