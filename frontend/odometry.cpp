#include "frontend/odometry.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <istream>
#include <ostream>

#include <Eigen/Cholesky>

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

// Adds a correspondence: q is the moved source point, r = q - its neighbour, n the plane's normal
// or zero. The residual is weighted by A = n n' + a (I - n n'): along a plane a neighbour says
// little, since it is not the same point; off planes A = I, which is KISS-ICP. The robust kernel is
// Geman-McClure of scale sigma (KISS-ICP, eq. 8).
void add_correspondence(NormalEquations& sum, const Eigen::Vector3d& q, const Eigen::Vector3d& r,
                        const Eigen::Vector3d& n, double sigma, double a) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  if (n.x() != 0.0 || n.y() != 0.0 || n.z() != 0.0) {
    A *= a;
    A.noalias() += (1.0 - a) * n * n.transpose();
  }
  const Eigen::Vector3d Ar = A * r;
  const double w = square(sigma) / square(sigma + r.dot(Ar));
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
                                                 double sigma, double convergence) const {
  if (map_.empty()) return {guess, 0};
  const auto max_distance = static_cast<float>(3.0 * sigma);
  const double plane_weight = options_.point_to_point ? 1.0 : options_.along_plane_weight;
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
            const Eigen::Vector3d q = p.cast<double>();
            const Eigen::Vector3d r = q - neighbor.point.cast<double>();
            add_correspondence(sum, q, r, neighbor.normal.cast<double>(), sigma, plane_weight);
          }
          return sum;
        });
    const Matrix6d full = system.H.selfadjointView<Eigen::Upper>();
    const Vector6d dx = full.ldlt().solve(-system.b);
    if (!dx.allFinite()) return {guess, iteration};
    pose = exp_se3(dx) * pose;
    if (dx.norm() < convergence) break;
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
  const double sigma = threshold();
  const Registration coarse =
      register_points(source, guess, sigma, std::max(options_.convergence, kCoarseConvergence));
  const Points fine_source = downsampler_(map_points, voxel);
  const Registration registration =
      register_points(fine_source, coarse.pose, std::min(sigma, options_.fine_threshold * voxel),
                      options_.convergence);

  const Pose deviation = guess.inverse() * registration.pose;
  const double model_error =
      deviation.translation.norm() +
      2.0 * options_.max_range * std::sin(0.5 * rotation_angle(deviation.rotation));
  if (scans_ > 0 && model_error > options_.min_motion) {
    deviation_sum_ += square(model_error);
    ++deviation_count_;
  }
  if (scans_ > 0 && step > 0.0 && step <= options_.max_gap) {
    twist_ = log_se3(T_world_middle_.inverse() * registration.pose) / step;
  }
  T_world_middle_ = registration.pose;
  middle_stamp_ = middle_stamp;
  ++scans_;

  map_.insert(map_points, T_world_middle_);
  const Eigen::Vector3f position = T_world_middle_.translation.cast<float>();
  if ((position - pruned_at_).norm() > kPruneDistance) {
    map_.remove_beyond(position, static_cast<float>(options_.max_range));
    pruned_at_ = position;
  }

  RegisteredScan result;
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
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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
  get(in, pruned_at_);
  map_.load(in);
}

}  // namespace groundloop
