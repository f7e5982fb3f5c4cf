#include "backend/registration/registration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "frontend/core/files.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kBlock = 512;

// Normal equations of one linearisation about T_target_source * exp(delta), delta = (t, r).
struct System {
  Matrix6d hessian = Matrix6d::Zero();  // lower triangle
  Vector6d gradient = Vector6d::Zero();
  Matrix6d normal_noise = Matrix6d::Zero();  // what errors of the normals add to the Hessian
  double weighted_squares = 0.0;
  double weights = 0.0;
  double inlier_squares = 0.0;
  Eigen::Vector3d inlier_sum = Eigen::Vector3d::Zero();  // source frame
  std::size_t inliers = 0;

  System& operator+=(const System& o) {
    hessian += o.hessian;
    gradient += o.gradient;
    normal_noise += o.normal_noise;
    weighted_squares += o.weighted_squares;
    weights += o.weights;
    inlier_squares += o.inlier_squares;
    inlier_sum += o.inlier_sum;
    inliers += o.inliers;
    return *this;
  }
};

// The nearest cell mean among the eight cells around `point`: complete within half a cell.
std::uint32_t nearest_cell(const VoxelLevel& level, const Eigen::Vector3f& point) {
  if (!has_voxel(point)) return VoxelTable::kNone;
  const Eigen::Vector3i corner =
      voxel_of(point - Eigen::Vector3f::Constant(0.5F * level.voxel_size), 1.0F / level.voxel_size);
  std::uint32_t best = VoxelTable::kNone;
  float best_distance = level.voxel_size * level.voxel_size;
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t cell =
        level.index.find(voxel_key(corner + Eigen::Vector3i(i & 1, (i >> 1) & 1, i >> 2)));
    if (cell == VoxelTable::kNone) continue;
    const float distance = (level.means[cell] - point).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = cell;
    }
  }
  return best;
}

// Linearises over every `stride`-th source cell.
System linearise(const VoxelLevel& target, const std::vector<Eigen::Vector3f>& source,
                 std::size_t stride, const Pose& T_target_source, float kernel,
                 bool for_information) {
  const PoseF T(T_target_source);
  const Eigen::Matrix3f R_source_target = T.rotation.transpose();
  const float kernel2 = kernel * kernel;
  const std::size_t n = (source.size() + stride - 1) / stride;
  return ordered_sum(n, kBlock, System{}, [&](std::size_t begin, std::size_t end) {
    System system;
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f& p = source[i * stride];
      const Eigen::Vector3f moved = T * p;
      const std::uint32_t c = nearest_cell(target, moved);
      if (c == VoxelTable::kNone) continue;
      const Eigen::Vector3f& normal = target.normals[c];
      if (normal.isZero(0.0F)) continue;
      const float residual = normal.dot(moved - target.means[c]);
      const float residual2 = residual * residual;
      // Geman-McClure, and less weight on rough surfaces (vegetation) than on smooth ones.
      const float robust = kernel2 / (kernel2 + residual2);
      const float smooth = kernel2 / (kernel2 + 4.0F * target.variances[c]);
      const double weight = robust * robust * smooth;
      const Eigen::Vector3f m = R_source_target * normal;
      Vector6d J;
      J << m.cast<double>(), p.cross(m).cast<double>();
      system.hessian.selfadjointView<Eigen::Lower>().rankUpdate(J, weight);
      if (for_information) {
        // Errors of the normals look like knowledge of the directions along the surface.
        const double noise = weight * target.normal_variances[c];
        Eigen::Matrix<double, 6, 3> A;
        A << Eigen::Matrix3d::Identity(), skew(p.cast<double>());
        system.normal_noise += noise * (A * A.transpose() - J * J.transpose());
      }
      system.gradient += weight * residual * J;
      system.weighted_squares += weight * residual2;
      system.weights += weight;
      if (residual2 < kernel2) {
        ++system.inliers;
        system.inlier_squares += residual2;
        system.inlier_sum += p.cast<double>();
      }
    }
    return system;
  });
}

// Rotations in metres at a lever of 10 m, so that both halves of a twist compare.
Vector6d lever_scale() {
  constexpr double kLever = 10.0;
  Vector6d scale;
  scale << 1.0, 1.0, 1.0, 1.0 / kLever, 1.0 / kLever, 1.0 / kLever;
  return scale;
}

// A step that leaves directions alone which the surfaces do not hold.
Vector6d solve(const System& system) {
  Matrix6d h = system.hessian.selfadjointView<Eigen::Lower>();
  const Vector6d scale = lever_scale();
  h = scale.asDiagonal() * h * scale.asDiagonal();
  h.diagonal().array() += 1e-6 * h.trace();
  const Vector6d step = h.ldlt().solve(scale.cwiseProduct(system.gradient));
  return -scale.cwiseProduct(step);
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

// A symmetric matrix without its negative eigenvalues, in metres at a lever of 10 m.
Matrix6d positive_part(const Matrix6d& matrix) {
  const Vector6d scale = lever_scale();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scale.asDiagonal() * matrix *
                                                       scale.asDiagonal());
  const Matrix6d scaled = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
                          solver.eigenvectors().transpose();
  const Vector6d inverse = scale.cwiseInverse();
  return inverse.asDiagonal() * scaled * inverse.asDiagonal();
}

double squared(double value) { return value * value; }
double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

// What no number of points goes below, at the centre of the overlap.
Matrix6d floor_covariance(const RegistrationOptions& options) {
  Vector6d floor;
  floor.head<3>().setConstant(squared(std::max(1e-6, options.translation_floor)));
  floor.tail<3>().setConstant(squared(std::max(1e-8, radians(options.rotation_floor_deg))));
  return floor.asDiagonal();
}

// Drift inside a map from its origin to the centre of the overlap, `way` being the vector between
// them: a random walk of position and heading along it, as an error at the centre. A heading lost
// at fraction s of the way displaces the centre by the rest, (1 - s) way.
Matrix6d drift_covariance(const Eigen::Vector3d& way, const RegistrationOptions& options) {
  const double length = way.norm();
  const double turn = squared(radians(options.rotation_drift_deg)) * length;
  const Eigen::Matrix3d lever = skew(way);
  Matrix6d covariance;
  covariance.topLeftCorner<3, 3>() =
      squared(options.translation_drift) * length * Eigen::Matrix3d::Identity() +
      turn / 3.0 * lever * lever.transpose();
  covariance.topRightCorner<3, 3>() = -0.5 * turn * lever;
  covariance.bottomLeftCorner<3, 3>() = -0.5 * turn * lever.transpose();
  covariance.bottomRightCorner<3, 3>() = turn * Eigen::Matrix3d::Identity();
  return covariance;
}

// Covariance = residual scatter through the Hessian, with as many independent residuals as there
// are groups of correlated ones, plus what no number of points removes: a floor at the overlap's
// centre and the drift from there to the origins of both maps.
Matrix6d scaled_information(const System& system, const Pose& T_target_source,
                            const RegistrationOptions& options) {
  const Eigen::Vector3d centre =
      system.inlier_sum / std::max<double>(1.0, static_cast<double>(system.inliers));
  const Matrix6d hessian = system.hessian.selfadjointView<Eigen::Lower>();
  const double variance =
      std::max(1e-6, system.weighted_squares / std::max(1.0, system.weights - 6.0));

  // About the overlap's centre: T exp(xi) with xi = Ad(T_source_centre) xi_centre.
  Pose T_source_centre;
  T_source_centre.translation = centre;
  const Matrix6d ad = adjoint(T_source_centre);
  const Matrix6d known = hessian - system.normal_noise;
  const Matrix6d information =
      positive_part(ad.transpose() * known * ad) / (variance * options.correlated_points);

  const Eigen::Vector3d to_target_origin =
      T_target_source.rotation.conjugate() * (T_target_source * centre);
  const Matrix6d floor = floor_covariance(options) + drift_covariance(centre, options) +
                         drift_covariance(to_target_origin, options);
  // (information^-1 + floor)^-1 without inverting a matrix that may be singular.
  const Matrix6d root = floor.llt().matrixL();
  const Matrix6d whitened = root.transpose() * information * root;
  const Matrix6d limited =
      Matrix6d::Identity() - (whitened + Matrix6d::Identity()).llt().solve(Matrix6d::Identity());
  const Matrix6d inverse_root = root.triangularView<Eigen::Lower>().solve(Matrix6d::Identity());
  const Matrix6d at_centre = inverse_root.transpose() * limited * inverse_root;
  const Matrix6d back = adjoint(T_source_centre.inverse());
  const Matrix6d result = back.transpose() * at_centre * back;
  return 0.5 * (result + result.transpose());
}

// One level of the pyramids, iterated until the steps are small.
struct LevelResult {
  Pose T_target_source;
  System system;  // at the last but one pose
  int iterations = 0;
  bool settled = false;
};

class Refinement {
 public:
  Refinement(const VoxelPyramid& target, const VoxelPyramid& source,
             const RegistrationOptions& options)
      : target_(target), source_(source), options_(options) {}

  [[nodiscard]] System linearise_at(std::size_t level, const Pose& T_target_source,
                                    bool for_information = false) const {
    const auto& points = source_.levels()[level].means;
    const VoxelLevel& surface = target_.levels()[level];
    return linearise(surface, points, stride_of(points.size()), T_target_source,
                     static_cast<float>(options_.kernel) * surface.voxel_size, for_information);
  }

  [[nodiscard]] LevelResult iterate(std::size_t level, const Pose& T_target_source) const {
    LevelResult result;
    result.T_target_source = T_target_source;
    // Coarse levels only bring the next one within reach.
    const double tolerance = level == 0 ? 1.0 : 4.0;
    while (result.iterations < options_.max_iterations && !result.settled) {
      result.system = linearise_at(level, result.T_target_source);
      if (result.system.inliers < 6) break;
      const Vector6d step = solve(result.system);
      if (!step.allFinite()) break;
      result.T_target_source = result.T_target_source * exp_se3(step);
      ++result.iterations;
      result.settled = step.head<3>().norm() < tolerance * options_.translation_tolerance &&
                       degrees(step.tail<3>().norm()) < tolerance * options_.rotation_tolerance_deg;
    }
    return result;
  }

 private:
  [[nodiscard]] std::size_t stride_of(std::size_t cells) const {
    const auto limit = static_cast<std::size_t>(options_.max_cells);
    return std::max<std::size_t>(1, (cells + limit - 1) / limit);
  }

  const VoxelPyramid& target_;
  const VoxelPyramid& source_;
  const RegistrationOptions& options_;
};

// The coarse levels from several headings: a long map's far end moves by metres with a few degrees,
// into another minimum. Coarse levels have few cells, so that this costs little.
Pose coarse_pose(const Refinement& refinement, const Pose& T_initial, std::size_t finest_coarse,
                 const RegistrationOptions& options, int& iterations) {
  const double turn = options.heading_starts_deg * std::numbers::pi / 180.0;
  Pose best = T_initial;
  double best_weight = -1.0;
  for (const double yaw : {0.0, turn, -turn}) {
    Pose pose = T_initial * Pose(exp_so3(Eigen::Vector3d(0.0, 0.0, yaw)), Eigen::Vector3d::Zero());
    for (auto level = static_cast<std::size_t>(options.levels); level-- > finest_coarse;) {
      const LevelResult result = refinement.iterate(level, pose);
      pose = result.T_target_source;
      iterations += result.iterations;
    }
    const double weight = refinement.linearise_at(finest_coarse, pose).weights;
    if (weight > best_weight) {
      best_weight = weight;
      best = pose;
    }
    if (turn == 0.0) break;
  }
  return best;
}

// Every n-th point, so that at most `limit` are left.
Points thinned(const Points& points, std::size_t limit) {
  const std::size_t stride = std::max<std::size_t>(1, (points.size() + limit - 1) / limit);
  if (stride == 1) return points;
  Points result;
  result.reserve(points.size() / stride + 1);
  for (std::size_t i = 0; i < points.size(); i += stride) result.push_back(points[i]);
  return result;
}

std::string failure_of(const RegistrationResult& result, const Pose& T_initial, bool settled,
                       const RegistrationOptions& options) {
  const Pose moved = T_initial.inverse() * result.T_target_source;
  const double turned = degrees(rotation_angle(moved.rotation));
  if (result.inliers < static_cast<std::size_t>(options.min_inliers)) {
    return std::to_string(result.inliers) + " cells on surfaces of the other map, at least " +
           std::to_string(options.min_inliers) + " are needed";
  }
  if (moved.translation.norm() > options.max_translation || turned > options.max_rotation_deg) {
    return "ended " + to_text(std::round(moved.translation.norm() * 100.0) / 100.0) + " m and " +
           to_text(std::round(turned * 100.0) / 100.0) + " degrees from its start";
  }
  if (!settled) return "steps did not become small";
  return {};
}

// The principal direction of the normals within 60 degrees of z, turned upward; z without any.
Eigen::Vector3f prevailing_normal(const VoxelLevel& level) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& normal : level.normals) {
    if (std::abs(normal.z()) < 0.5F) continue;
    const Eigen::Vector3d n = normal.cast<double>();
    sum += n * n.transpose();
  }
  if (sum.isZero(0.0)) return Eigen::Vector3f::UnitZ();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
  const Eigen::Vector3f up = solver.eigenvectors().col(2).cast<float>();
  return up.z() < 0.0F ? Eigen::Vector3f(-up) : up;
}

}  // namespace

RegistrationTarget::RegistrationTarget(const Points& points, const RegistrationOptions& options)
    : pyramid_(points, options.voxel_size, options.levels, true),
      up_(prevailing_normal(pyramid_.finest())),
      columns_(points, Pose(), up_) {}

RegistrationResult register_points(const RegistrationTarget& target, const Points& source,
                                   const Pose& T_target_source_initial,
                                   const RegistrationOptions& options) {
  const VoxelPyramid cells(thinned(source, static_cast<std::size_t>(options.max_points)),
                           options.voxel_size, options.levels, false);
  const Refinement refinement(target.pyramid(), cells, options);
  RegistrationResult result;
  result.T_target_source = T_target_source_initial;
  std::size_t level = std::min<std::size_t>(2, static_cast<std::size_t>(options.levels) - 1);
  if (level > 0) {
    result.T_target_source =
        coarse_pose(refinement, T_target_source_initial, level, options, result.iterations);
  } else {
    level = 1;
  }
  bool settled = false;
  while (level-- > 0) {
    const LevelResult fine = refinement.iterate(level, result.T_target_source);
    result.T_target_source = fine.T_target_source;
    result.iterations += fine.iterations;
    settled = fine.settled;
  }
  const System system = refinement.linearise_at(0, result.T_target_source, true);
  result.inliers = system.inliers;
  if (system.inliers == 0) {
    result.failure = "no cell of one map lies on a surface of the other";
    return result;
  }
  result.rmse = std::sqrt(system.inlier_squares / static_cast<double>(system.inliers));
  result.information = scaled_information(system, result.T_target_source, options);
  result.failure = failure_of(result, T_target_source_initial, settled, options);
  result.converged = result.failure.empty();
  return result;
}

}  // namespace groundloop
