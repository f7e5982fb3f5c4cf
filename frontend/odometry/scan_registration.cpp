#include "frontend/odometry/scan_registration.hpp"

#include <Eigen/Cholesky>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kBlock = 256;
// What is known of the turn where no point tells: 0.02 rad are as much as a residual of 0.3 m.
constexpr double kTurnInformation = (0.3 * 0.3) / (0.02 * 0.02);

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();  // the upper triangle
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
// Else A = I times the scatter weight. The robust kernel is Geman-McClure (KISS-ICP, eq. 8).
// Perturbations turn about the point that is `arm` before q.
void add_correspondence(NormalEquations& sum, const Eigen::Vector3d& q, const Eigen::Vector3d& arm,
                        const VoxelMap::Neighbor& neighbor, const RegistrationKernel& kernel) {
  const double a = kernel.along_plane;
  double scatter = kernel.scatter_weight;
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
  const double w = scatter * square(kernel.sigma) / square(kernel.sigma + r.dot(Ar));
  // J = [I | -skew(arm)] for a perturbation on the left.
  Eigen::Matrix3d AS;  // A * -skew(arm), column by column
  AS.col(0) = arm.y() * A.col(2) - arm.z() * A.col(1);
  AS.col(1) = arm.z() * A.col(0) - arm.x() * A.col(2);
  AS.col(2) = arm.x() * A.col(1) - arm.y() * A.col(0);
  sum.H.topLeftCorner<3, 3>() += w * A;
  sum.H.topRightCorner<3, 3>() += w * AS;
  Eigen::Matrix3d SAS;  // -skew(arm)' * AS = skew(arm) * AS
  for (int k = 0; k < 3; ++k) SAS.col(k) = arm.cross(Eigen::Vector3d(AS.col(k)));
  sum.H.bottomRightCorner<3, 3>() += w * SAS;
  sum.b.head<3>() += w * Ar;
  sum.b.tail<3>() += w * arm.cross(Ar);
}

// Moments in time of the normal equations: a point at time s turns by (turn of the middle) +
// s (turn to the end), so that its Jacobian for the latter is s times that for the former.
struct TurningEquations {
  NormalEquations rigid;
  Eigen::Matrix<double, 6, 3> first = Eigen::Matrix<double, 6, 3>::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  TurningEquations& operator+=(const TurningEquations& other) {
    rigid += other.rigid;
    first += other.first;
    second += other.second;
    b += other.b;
    return *this;
  }
  void add(const NormalEquations& point, double s) {
    rigid += point;
    first += s * point.H.rightCols<3>();
    second += s * s * point.H.bottomRightCorner<3, 3>();
    b += s * point.b.tail<3>();
  }
  // The update (translation, rotation, turn), from a turn of `turn` so far.
  [[nodiscard]] Vector9d solve(const Eigen::Vector3d& turn) const {
    Matrix9d H = Matrix9d::Zero();
    H.topLeftCorner<6, 6>() = rigid.H;
    H.topRightCorner<6, 3>() = first;
    H.bottomRightCorner<3, 3>() = second + kTurnInformation * Eigen::Matrix3d::Identity();
    Vector9d gradient;
    gradient << rigid.b, b + kTurnInformation * turn;
    const Matrix9d full = H.selfadjointView<Eigen::Upper>();
    return full.ldlt().solve(-gradient);
  }
};

}  // namespace

ScanRegistration register_scan(const VoxelMap& map, const Points& source, const Pose& guess,
                               const RegistrationKernel& kernel) {
  if (map.empty()) return {guess, 0};
  const auto max_distance = static_cast<float>(3.0 * kernel.sigma);
  Pose pose = guess;
  int iteration = 0;
  while (iteration < kernel.max_iterations) {
    ++iteration;
    const PoseF T(pose);
    const NormalEquations system = ordered_sum<NormalEquations>(
        source.size(), kBlock, {}, [&](std::size_t begin, std::size_t end) {
          NormalEquations sum;
          for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Vector3f p = T * source[i];
            const VoxelMap::Neighbor neighbor = map.nearest(p, max_distance);
            if (neighbor.squared_distance > max_distance * max_distance) continue;
            const Eigen::Vector3d q = p.cast<double>();
            add_correspondence(sum, q, q, neighbor, kernel);
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

TurningRegistration register_turning_scan(const VoxelMap& map, const SweepPoints& source,
                                          const Pose& guess, const RegistrationKernel& kernel) {
  TurningRegistration unchanged{guess, Eigen::Vector3d::Zero(), 0};
  if (map.empty()) return unchanged;
  const auto max_distance = static_cast<float>(3.0 * kernel.sigma);
  TurningRegistration result = unchanged;
  while (result.iterations < kernel.max_iterations) {
    ++result.iterations;
    const PoseF T(result.pose);
    const Eigen::Vector3f turn = result.turn.cast<float>();
    const TurningEquations system = ordered_sum<TurningEquations>(
        source.points.size(), kBlock, {}, [&](std::size_t begin, std::size_t end) {
          TurningEquations sum;
          for (std::size_t i = begin; i < end; ++i) {
            // exp(s turn) to second order: a turn is a few hundredths of a radian.
            const Eigen::Vector3f w = source.times[i] * turn;
            const Eigen::Vector3f moved = w.cross(source.points[i]);
            const Eigen::Vector3f p = T * (source.points[i] + moved + 0.5F * w.cross(moved));
            const VoxelMap::Neighbor neighbor = map.nearest(p, max_distance);
            if (neighbor.squared_distance > max_distance * max_distance) continue;
            const Eigen::Vector3d q = p.cast<double>();
            NormalEquations point;
            add_correspondence(point, q, q - result.pose.translation, neighbor, kernel);
            sum.add(point, static_cast<double>(source.times[i]));
          }
          return sum;
        });
    const Vector9d dx = system.solve(result.pose.rotation * result.turn);
    if (!dx.allFinite()) return {guess, Eigen::Vector3d::Zero(), result.iterations};
    const Eigen::Quaterniond rotation = exp_so3(dx.segment<3>(3)) * result.pose.rotation;
    result.pose = Pose(rotation, result.pose.translation + dx.head<3>());
    result.turn += rotation.conjugate() * Eigen::Vector3d(dx.tail<3>());
    if (dx.norm() < kernel.convergence) break;
  }
  return result;
}

}  // namespace groundloop
