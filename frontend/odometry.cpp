#include "frontend/odometry.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <istream>
#include <ostream>

#include <Eigen/Cholesky>
#include <spdlog/spdlog.h>

#include "frontend/core/binary_io.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kRegistrationBlock = 256;
// Voxels out of range are dropped once the sensor has moved this far since the last time.
constexpr float kPruneDistance = 5.0F;
// Update (m, rad) that ends the coarse registration: the fine one goes on from there.
constexpr double kCoarseConvergence = 1e-2;
// Share of a scan in the running mean of how many voxels scans fill.
constexpr double kUsualGain = 0.05;

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  NormalEquations& operator+=(const NormalEquations& other) {
    H += other.H;
    b += other.b;
    return *this;
  }
};

double square(double v) { return v * v; }

// Adds a correspondence: q is the moved source point, r = q - its neighbour. Where that lies on a
// plane of normal n, the residual is the distance to the plane across it, weighted by
// A = n n' + a (I - n n'): along the plane a neighbour says little, since it is not the same point.
// Else A = I times `scatter`. The robust kernel is Geman-McClure of scale sigma (KISS-ICP, eq. 8).
void add_correspondence(NormalEquations& sum, const Eigen::Vector3d& q,
                        const VoxelMap::Neighbor& neighbor, double sigma, double a,
                        double scatter) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  Eigen::Vector3d r = q - neighbor.point.cast<double>();
  if (neighbor.plane.exists() && a < 1.0) {
    const Eigen::Vector3d n = neighbor.plane.normal.cast<double>();
    // The plane of many points is better known than its nearest point.
    r += n * (n.dot(q - neighbor.plane.point.cast<double>()) - n.dot(r));
    A *= a;
    A.noalias() += (1.0 - a) * n * n.transpose();
    scatter = 1.0;
  }
  const Eigen::Vector3d Ar = A * r;
  const double w = scatter * square(sigma) / square(sigma + r.dot(Ar));
  // J = [I | -skew(q)] for a perturbation on the left.
  Eigen::Matrix3d AS;  // A * -skew(q), column by column
  AS.col(0) = q.y() * A.col(2) - q.z() * A.col(1);
  AS.col(1) = q.z() * A.col(0) - q.x() * A.col(2);
  AS.col(2) = q.x() * A.col(1) - q.y() * A.col(0);
  sum.H.topLeftCorner<3, 3>() += w * A;
  sum.H.topRightCorner<3, 3>() += w * AS;
  Eigen::Matrix3d SAS;  // -skew(q)' * AS = skew(q) * AS
  for (int k = 0; k < 3; ++k) SAS.col(k) = q.cross(Eigen::Vector3d(AS.col(k)));
  sum.H.bottomRightCorner<3, 3>() += w * SAS;
  sum.b.head<3>() += w * Ar;
  sum.b.tail<3>() += w * q.cross(Ar);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double sweep_middle(const Scan& scan) {
  if (scan.times.empty()) return 0.0;
  const auto [min, max] = std::minmax_element(scan.times.begin(), scan.times.end());
  return 0.5 * (static_cast<double>(*min) + static_cast<double>(*max));
}

}  // namespace

Odometry::Odometry(const OdometryOptions& options)
    : options_(options),
      map_(static_cast<float>(options.voxel_size)),
      deviation_sum_(square(options.initial_threshold)),
      deviation_count_(1) {}

double Odometry::threshold() const {
  return std::sqrt(deviation_sum_ / static_cast<double>(deviation_count_));
}

Odometry::Registration Odometry::register_points(const Points& source, const Pose& guess,
                                                 const Kernel& kernel) const {
  if (map_.empty()) return {guess, 0};
  const auto max_distance = static_cast<float>(3.0 * kernel.sigma);
  const double along = options_.point_to_point ? 1.0 : options_.along_plane_weight;
  const double scatter = options_.point_to_point ? 1.0 : kernel.scatter_weight;
  Pose pose = guess;
  int iteration = 0;
  while (iteration < options_.max_iterations) {
    ++iteration;
    const PoseF T(pose);
    const NormalEquations system = ordered_sum<NormalEquations>(
        source.size(), kRegistrationBlock, {}, [&](std::size_t begin, std::size_t end) {
          NormalEquations sum;
          for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Vector3f p = T * source[i];
            const VoxelMap::Neighbor neighbor = map_.nearest(p, max_distance);
            if (neighbor.squared_distance > max_distance * max_distance) continue;
            add_correspondence(sum, p.cast<double>(), neighbor, kernel.sigma, along, scatter);
          }
          return sum;
        });
    const Matrix6d full = system.H.selfadjointView<Eigen::Upper>();
    const Vector6d dx = full.ldlt().solve(-system.b);
    if (!dx.allFinite()) return {guess, iteration};
    pose = exp_se3(dx) * pose;
    if (dx.norm() < kernel.convergence) break;
  }
  return {pose, iteration};
}

void Odometry::start(const Scan& first, const Scan& second) {
  Odometry trial(options_);
  // Two rounds: the velocity that the first finds deskews the second.
  for (int round = 0; round < 2; ++round) {
    Odometry next(options_);
    next.twist_ = trial.twist_;
    next.add(first, "first scan");
    next.add(second, "second scan");
    trial.twist_ = next.twist_;
  }
  twist_ = trial.twist_;
  T_world_middle_ = exp_se3(sweep_middle(first) * twist_);
}

bool Odometry::blocked(std::size_t voxels) {
  const auto count = static_cast<double>(voxels);
  const bool few = scans_ > 0 && count < options_.blocked_share * usual_voxels_;
  if (few && blocked_ < options_.max_blocked) {
    ++blocked_;
    return true;
  }
  blocked_ = 0;
  // A view that stays narrow is the usual one from now on.
  usual_voxels_ += (few || scans_ == 0 ? 1.0 : kUsualGain) * (count - usual_voxels_);
  return false;
}

// Adapts the threshold and the velocity to the step from T_world_middle_ to `registered`.
void Odometry::learn_motion(const Pose& guess, double step, const Pose& registered) {
  const Pose deviation = guess.inverse() * registered;
  const double model_error =
      deviation.translation.norm() +
      2.0 * options_.max_range * std::sin(0.5 * rotation_angle(deviation.rotation));
  if (model_error > options_.min_motion) {
    deviation_sum_ += square(model_error);
    ++deviation_count_;
  }
  if (step > 0.0 && step <= options_.max_gap) {
    twist_ = log_se3(T_world_middle_.inverse() * registered) / step;
  }
}

RegisteredScan Odometry::add(const Scan& scan, const std::string& name) {
  const auto start = std::chrono::steady_clock::now();
  const double middle = sweep_middle(scan);
  const Nanoseconds middle_stamp =
      scan.stamp + static_cast<Nanoseconds>(std::llround(middle * 1e9));

  Points points = deskew_and_crop(scan, twist_, middle, options_.min_range, options_.max_range);
  if (points.size() < static_cast<std::size_t>(options_.min_points)) {
    throw InputError(name + ": only " + std::to_string(points.size()) + " points between " +
                     std::to_string(options_.min_range) + " and " +
                     std::to_string(options_.max_range) + " m, at least " +
                     std::to_string(options_.min_points) +
                     " are needed to register a scan; check the sensor, the range limits, or leave "
                     "the scan out with "
                     "--first and --count");
  }
  const auto voxel = static_cast<float>(options_.voxel_size);
  const Points map_points = downsampler_(points, 0.5F * voxel);
  const Points source = downsampler_(map_points, 1.5F * voxel);

  const double step = static_cast<double>(middle_stamp - middle_stamp_) * 1e-9;
  // Across a gap, or where stamps do not advance, the velocity says little.
  const double trusted_step = scans_ == 0 ? 0.0 : std::clamp(step, 0.0, options_.max_gap);
  const Pose guess = T_world_middle_ * exp_se3(trusted_step * twist_);
  RegisteredScan result;
  if (blocked(source.size())) {
    if (blocked_ == 1) {
      spdlog::warn(
          "{}: the view is blocked ({} voxels filled, {:.0f} are usual); its pose is "
          "predicted from the velocity",
          name, source.size(), usual_voxels_);
    }
    ++predicted_scans_;
    T_world_middle_ = guess;
    middle_stamp_ = middle_stamp;
    ++scans_;
    result.T_world_scan = guess * exp_se3(-middle * twist_);
    result.seconds = seconds_since(start);
    return result;
  }
  const double sigma = threshold();
  const Registration coarse = register_points(
      source, guess, {sigma, 1.0, std::max(options_.convergence, kCoarseConvergence)});
  const Points fine_source = downsampler_(map_points, voxel);
  const Registration registration =
      register_points(fine_source, coarse.pose,
                      {std::min(sigma, options_.fine_threshold * voxel), options_.scatter_weight,
                       options_.convergence});

  if (scans_ > 0) learn_motion(guess, step, registration.pose);
  T_world_middle_ = registration.pose;
  middle_stamp_ = middle_stamp;
  ++scans_;

  map_.insert(map_points, T_world_middle_);
  const Eigen::Vector3f position = T_world_middle_.translation.cast<float>();
  if ((position - pruned_at_).norm() > kPruneDistance) {
    map_.remove_beyond(position, static_cast<float>(options_.max_range));
    pruned_at_ = position;
  }

  // From the middle of the sweep to the instant of the stamp, with the velocity just measured.
  const Pose T_middle_scan = exp_se3(-middle * twist_);
  result.T_world_scan = T_world_middle_ * T_middle_scan;
  result.points = std::move(points);
  if (middle != 0.0) {
    const PoseF T_scan_middle(T_middle_scan.inverse());
    for (Eigen::Vector3f& p : result.points) p = T_scan_middle * p;
  }
  result.registration_points = source.size() + fine_source.size();
  result.iterations = coarse.iterations + registration.iterations;
  result.seconds = seconds_since(start);
  return result;
}

void Odometry::save(std::ostream& out) const {
  put(out, T_world_middle_.rotation.coeffs());
  put(out, T_world_middle_.translation);
  put(out, middle_stamp_);
  put(out, twist_);
  put(out, deviation_sum_);
  put(out, deviation_count_);
  put(out, scans_);
  put(out, usual_voxels_);
  put(out, blocked_);
  put(out, predicted_scans_);
  put(out, pruned_at_);
  map_.save(out);
}

void Odometry::load(std::istream& in) {
  get(in, T_world_middle_.rotation.coeffs());
  get(in, T_world_middle_.translation);
  get(in, middle_stamp_);
  get(in, twist_);
  get(in, deviation_sum_);
  get(in, deviation_count_);
  get(in, scans_);
  get(in, usual_voxels_);
  get(in, blocked_);
  get(in, predicted_scans_);
  get(in, pruned_at_);
  map_.load(in);
}

}  // namespace groundloop
