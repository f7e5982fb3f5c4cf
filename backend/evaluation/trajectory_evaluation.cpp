#include "backend/evaluation/trajectory_evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>

#include <Eigen/SVD>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::vector<std::size_t> order_by_stamp(const Trajectory& trajectory) {
  std::vector<std::size_t> order(trajectory.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return trajectory[a].stamp < trajectory[b].stamp;
  });
  return order;
}

// For each pose of `few` the nearest of `many`, each of which is kept for its nearest partner only.
std::vector<std::pair<std::size_t, std::size_t>> associate_nearest(const Trajectory& few,
                                                                   const Trajectory& many,
                                                                   Nanoseconds tolerance) {
  const std::vector<std::size_t> few_order = order_by_stamp(few);
  const std::vector<std::size_t> many_order = order_by_stamp(many);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::size_t j = 0;
  Nanoseconds last_distance = 0;
  for (const std::size_t i : few_order) {
    const auto distance = [&](std::size_t k) {
      return std::abs(many[many_order[k]].stamp - few[i].stamp);
    };
    while (j + 1 < many_order.size() && distance(j + 1) < distance(j)) ++j;
    if (distance(j) > tolerance) continue;
    if (!pairs.empty() && pairs.back().second == many_order[j]) {
      if (distance(j) >= last_distance) continue;
      pairs.pop_back();
    }
    pairs.emplace_back(i, many_order[j]);
    last_distance = distance(j);
  }
  return pairs;
}

struct PoseError {
  double translation_m;
  double rotation_deg;
};

PoseErrorStatistics pose_error_statistics(const std::vector<PoseError>& errors) {
  std::vector<double> translation;
  std::vector<double> rotation;
  for (const PoseError& e : errors) {
    translation.push_back(e.translation_m);
    rotation.push_back(e.rotation_deg);
  }
  return {errors.size(), statistics(std::move(translation)), statistics(std::move(rotation))};
}

PoseError relative_error(const std::vector<Pose>& estimate, const std::vector<Pose>& ground_truth,
                         std::size_t i, std::size_t j) {
  const Pose T_gt = ground_truth[i].inverse() * ground_truth[j];
  const Pose T_est = estimate[i].inverse() * estimate[j];
  const Pose error = T_gt.inverse() * T_est;
  return {error.translation.norm(), rotation_angle(error.rotation) * kDegrees};
}

std::vector<double> distances_along(const std::vector<Pose>& poses) {
  std::vector<double> distance(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    distance[i] = distance[i - 1] + (poses[i].translation - poses[i - 1].translation).norm();
  }
  return distance;
}

void evaluate_relative(const std::vector<Pose>& estimate, const std::vector<Pose>& ground_truth,
                       double rpe_distance, TrajectoryEvaluation& result) {
  const std::vector<double> way = distances_along(ground_truth);
  result.path_length_m = way.back();
  std::vector<PoseError> by_frame;
  std::vector<PoseError> by_distance;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    by_frame.push_back(relative_error(estimate, ground_truth, i, i + 1));
    const auto end = std::lower_bound(way.begin(), way.end(), way[i] + rpe_distance);
    if (end == way.end()) continue;
    by_distance.push_back(
        relative_error(estimate, ground_truth, i, static_cast<std::size_t>(end - way.begin())));
  }
  result.rpe_frame = pose_error_statistics(by_frame);
  result.rpe_distance = pose_error_statistics(by_distance);
  result.rpe_distance_m = rpe_distance;

  double translation = 0.0;
  double rotation = 0.0;
  for (std::size_t i = 0; i < way.size(); i += 10) {
    for (int length = 100; length <= 800; length += 100) {
      // The benchmark's own kit takes the first pose strictly beyond the length.
      const auto end = std::upper_bound(way.begin(), way.end(), way[i] + length);
      if (end == way.end()) break;
      const PoseError error =
          relative_error(estimate, ground_truth, i, static_cast<std::size_t>(end - way.begin()));
      translation += error.translation_m / length;
      rotation += error.rotation_deg / length;
      ++result.kitti_segments;
    }
  }
  if (result.kitti_segments > 0) {
    const auto n = static_cast<double>(result.kitti_segments);
    result.kitti_translation_percent = 100.0 * translation / n;
    result.kitti_rotation_deg_per_m = rotation / n;
  }
}

void evaluate_absolute(const std::vector<Pose>& aligned, const std::vector<Pose>& ground_truth,
                       TrajectoryEvaluation& result) {
  std::vector<PoseError> errors;
  std::array<std::vector<double>, 3> along;
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    const Eigen::Vector3d difference = ground_truth[i].translation - aligned[i].translation;
    const double angle =
        rotation_angle(ground_truth[i].rotation.conjugate() * aligned[i].rotation) * kDegrees;
    result.translation_errors.push_back(difference);
    result.rotation_errors_deg.push_back(angle);
    errors.push_back({difference.norm(), angle});
    for (int k = 0; k < 3; ++k) along[k].push_back(std::abs(difference[k]));
  }
  result.ape = pose_error_statistics(errors);
  result.ape_x_m = statistics(std::move(along[0]));
  result.ape_y_m = statistics(std::move(along[1]));
  result.ape_z_m = statistics(std::move(along[2]));
}

Alignment choose_alignment(const std::string& kind, const std::vector<Pose>& estimate,
                           const std::vector<Pose>& ground_truth) {
  if (kind == "origin") return {ground_truth.front() * estimate.front().inverse(), 1.0};
  if (kind == "se3") return align_umeyama(estimate, ground_truth, false);
  if (kind == "sim3") return align_umeyama(estimate, ground_truth, true);
  return {};
}

}  // namespace

Statistics statistics(std::vector<double> values) {
  Statistics s;
  if (values.empty()) return s;
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double squares = 0.0;
  for (const double v : values) {
    s.mean += v;
    squares += v * v;
  }
  s.mean /= n;
  s.rmse = std::sqrt(squares / n);
  double deviations = 0.0;
  for (const double v : values) deviations += (v - s.mean) * (v - s.mean);
  s.std = std::sqrt(deviations / n);
  const std::size_t half = values.size() / 2;
  s.median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  s.min = values.front();
  s.max = values.back();
  return s;
}

std::vector<std::pair<std::size_t, std::size_t>> associate(const Trajectory& estimate,
                                                           const Trajectory& ground_truth,
                                                           double tolerance) {
  if (estimate.empty() || ground_truth.empty()) return {};
  const auto nanoseconds = static_cast<Nanoseconds>(std::llround(tolerance * 1e9));
  if (estimate.size() <= ground_truth.size()) {
    return associate_nearest(estimate, ground_truth, nanoseconds);
  }
  auto pairs = associate_nearest(ground_truth, estimate, nanoseconds);
  for (auto& [a, b] : pairs) std::swap(a, b);
  return pairs;
}

Alignment align_umeyama(const std::vector<Pose>& estimate, const std::vector<Pose>& ground_truth,
                        bool with_scale) {
  const auto n = static_cast<double>(estimate.size());
  Eigen::Vector3d mean_estimate = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_truth = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    mean_estimate += estimate[i].translation;
    mean_truth += ground_truth[i].translation;
  }
  mean_estimate /= n;
  mean_truth /= n;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Zero();
  double variance = 0.0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Eigen::Vector3d centred = estimate[i].translation - mean_estimate;
    covariance += (ground_truth[i].translation - mean_truth) * centred.transpose() / n;
    orientation +=
        (ground_truth[i].rotation * estimate[i].rotation.conjugate()).toRotationMatrix() / n;
    variance += centred.squaredNorm() / n;
  }
  Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d singular = svd.singularValues();
  if (singular[1] <= 1e-9 * singular[0] || singular[0] <= 1e-12) {
    // Too weak to move what the positions decide, enough to decide what they leave free.
    const double weight = singular[0] <= 1e-12 ? 1.0 : 1e-6 * singular[0];
    svd.compute(covariance + weight * orientation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    singular = svd.singularValues();
  }
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign[2] = -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  Alignment alignment;
  if (with_scale && variance > 0.0) alignment.scale = singular.dot(sign) / variance;
  alignment.pose = Pose(rotation, mean_truth - alignment.scale * (rotation * mean_estimate));
  return alignment;
}

TrajectoryEvaluation evaluate_trajectory(const Trajectory& estimate, const Trajectory& ground_truth,
                                         const TrajectoryEvaluationOptions& options) {
  validate(options, "trajectory_evaluation");
  TrajectoryEvaluation result;
  if (options.by_row) {
    if (estimate.size() != ground_truth.size()) {
      throw InputError("the estimate has " + std::to_string(estimate.size()) +
                       " poses and the ground truth " + std::to_string(ground_truth.size()) +
                       "; poses without stamps are paired by row and need equal numbers");
    }
    for (std::size_t i = 0; i < estimate.size(); ++i) result.pairs.emplace_back(i, i);
  } else {
    result.pairs = associate(estimate, ground_truth, options.tolerance);
  }
  if (result.pairs.empty()) {
    std::string text = "no pose of the estimate (" + std::to_string(estimate.size()) +
                       " poses) has a ground-truth pose (" + std::to_string(ground_truth.size()) +
                       ") within " + to_text(options.tolerance) + " s";
    if (!estimate.empty() && !ground_truth.empty()) {
      text += "; the first stamps are " + seconds_text(estimate.front().stamp) + " and " +
              seconds_text(ground_truth.front().stamp) + " s, a larger tolerance may help";
    }
    throw InputError(text);
  }

  std::vector<Pose> estimated;
  std::vector<Pose> truth;
  for (const auto& [i, j] : result.pairs) {
    estimated.push_back(estimate[i].pose);
    truth.push_back(ground_truth[j].pose);
  }
  result.alignment = choose_alignment(options.alignment, estimated, truth);
  for (Pose& pose : estimated) pose.translation *= result.alignment.scale;
  evaluate_relative(estimated, truth, options.rpe_distance, result);
  for (Pose& pose : estimated) pose = result.alignment.pose * pose;
  evaluate_absolute(estimated, truth, result);
  return result;
}

}  // namespace groundloop
