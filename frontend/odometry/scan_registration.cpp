#include "frontend/odometry/scan_registration.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kBlock = 256;
// What is known of the turn where no point tells: 0.02 rad are as much as a residual of 0.3 m.
constexpr double kTurnInformation = (0.3 * 0.3) / (0.02 * 0.02);

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

float square(float v) { return v * v; }

// Moments in time of the normal equations: a point at time s turns by (turn of the middle) +
// s (turn to the end), so that its Jacobian for the latter is s times that for the former.
struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  Eigen::Matrix<double, 6, 3> first = Eigen::Matrix<double, 6, 3>::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b_turn = Eigen::Vector3d::Zero();
  double weight = 0.0, squares = 0.0;
  std::size_t count = 0;

  NormalEquations& operator+=(const NormalEquations& other) {
    H += other.H;
    b += other.b;
    first += other.first;
    second += other.second;
    b_turn += other.b_turn;
    weight += other.weight;
    squares += other.squares;
    count += other.count;
    return *this;
  }

  // The update of a rigid scan's pose.
  [[nodiscard]] Vector6d solve() const { return H.ldlt().solve(-b); }
  // The update (translation, rotation, turn), from a turn of `turn` so far.
  [[nodiscard]] Vector9d solve(const Eigen::Vector3d& turn) const {
    Matrix9d full;
    full << H, first, first.transpose(), second + kTurnInformation * Eigen::Matrix3d::Identity();
    Vector9d gradient;
    gradient << b, b_turn + kTurnInformation * turn;
    return full.ldlt().solve(-gradient);
  }
};

// What is remembered of a point from one iteration to the next: its neighbour is searched anew
// only once the point has moved so far that another could be nearer.
struct Match {
  VoxelMap::Neighbor neighbor{};
  Eigen::Vector3f searched_at = Eigen::Vector3f::Zero();
  bool searched = false;
};

class Registration {
 public:
  Registration(const VoxelMap& map, const SweepPoints& source, const Pose& guess,
               const RegistrationKernel& kernel)
      : map_(map),
        source_(source),
        kernel_(kernel),
        guess_(guess),
        anchor_(map.anchor_at(guess.translation)),
        pose_(anchor_.inside(guess)),
        matches_(source.points.size()) {}

  ScanRegistration run() {
    ScanRegistration result;
    result.pose = guess_;
    if (map_.empty() || source_.points.empty()) return result;
    const bool turns = !source_.times.empty();
    while (!result.converged && result.iterations < kernel_.max_iterations) {
      ++result.iterations;
      const NormalEquations sum = ordered_sum<NormalEquations>(
          source_.points.size(), kBlock, {}, [&](std::size_t begin, std::size_t end) {
            return turns ? equations<true>(begin, end) : equations<false>(begin, end);
          });
      describe(sum, result);
      Vector9d dx = Vector9d::Zero();
      if (turns) {
        dx = sum.solve(turn_);
      } else {
        dx.head<6>() = sum.solve();
      }
      if (!dx.allFinite()) return result;
      pose_ = pose_ * exp_se3(dx.head<6>());
      turn_ += dx.tail<3>();
      result.converged = dx.head<3>().norm() < kernel_.stop_translation &&
                         dx.segment<3>(3).norm() < kernel_.stop_rotation &&
                         dx.tail<3>().norm() < kernel_.stop_rotation;
    }
    result.pose = anchor_.outside(pose_);
    result.turn = turn_;
    return result;
  }

 private:
  void describe(const NormalEquations& sum, ScanRegistration& result) const {
    result.information = sum.H;
    result.correspondences = sum.count;
    result.inlier_share = sum.weight / static_cast<double>(source_.points.size());
    result.residual = sum.weight > 0.0 ? std::sqrt(sum.squares / sum.weight) : 0.0;
  }

  template <bool turns>
  NormalEquations equations(std::size_t begin, std::size_t end) {
    NormalEquations sum;
    const PoseF T(pose_);
    const Eigen::Matrix3f R_scan_anchor = T.rotation.transpose();
    const Eigen::Vector3f turn = turn_.cast<float>();
    const auto max_distance = static_cast<float>(3.0 * kernel_.sigma);
    for (std::size_t i = begin; i < end; ++i) {
      Eigen::Vector3f p = source_.points[i];
      if constexpr (turns) {
        // exp(s turn) to second order: a turn is a few hundredths of a radian.
        const Eigen::Vector3f w = source_.times[i] * turn;
        const Eigen::Vector3f moved = w.cross(p);
        p += moved + 0.5F * w.cross(moved);
      }
      const Eigen::Vector3f q = T * p;
      const VoxelMap::Neighbor& neighbor = neighbor_of(matches_[i], q, max_distance);
      if ((q - neighbor.point).squaredNorm() > max_distance * max_distance) continue;
      add<turns>(sum, i, p, q, R_scan_anchor, neighbor);
    }
    return sum;
  }

  const VoxelMap::Neighbor& neighbor_of(Match& match, const Eigen::Vector3f& q,
                                        float max_distance) const {
    const bool unchanged =
        match.searched && (q - match.searched_at).squaredNorm() < square(match.neighbor.reach);
    if (!unchanged) {
      match.neighbor = map_.nearest(anchor_, q, max_distance);
      match.searched_at = q;
      match.searched = true;
    }
    return match.neighbor;
  }

  // q is the moved point, p the same in the scan's frame, r = q - its neighbour. Where that lies on
  // a plane of normal n, the residual is the distance to the plane across it, weighted by
  // A = n n' + a (I - n n'): along the plane a neighbour says little, since it is not the same
  // point. Else A = I times the scatter weight. The robust kernel is Geman-McClure (KISS-ICP, eq.
  // 8). All in the scan's axes.
  template <bool turns>
  void add(NormalEquations& sum, std::size_t i, const Eigen::Vector3f& p, const Eigen::Vector3f& q,
           const Eigen::Matrix3f& R_scan_anchor, const VoxelMap::Neighbor& neighbor) const {
    Eigen::Vector3d r = (R_scan_anchor * (q - neighbor.point)).cast<double>();
    Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
    double weight = kernel_.scatter_weight;
    const double along = kernel_.along_plane;
    if (neighbor.plane.exists() && along < 1.0) {
      // The plane of many points is better known than its nearest point.
      const auto across = static_cast<double>(neighbor.plane.distance(q));
      const Eigen::Vector3d n = (R_scan_anchor * neighbor.plane.normal).cast<double>();
      r += n * (across - n.dot(r));
      A *= along;
      A.noalias() += (1.0 - along) * n * n.transpose();
      weight = 1.0;
    }
    const Eigen::Vector3d Ar = A * r;
    const double rAr = r.dot(Ar);
    const double kernel = kernel_.sigma / (kernel_.sigma + rAr);
    const double w = weight * kernel * kernel;
    const Eigen::Vector3d arm = p.cast<double>();
    // J = [I | -skew(arm)].
    Eigen::Matrix3d AS;  // A * -skew(arm), column by column
    AS.col(0) = arm.y() * A.col(2) - arm.z() * A.col(1);
    AS.col(1) = arm.z() * A.col(0) - arm.x() * A.col(2);
    AS.col(2) = arm.x() * A.col(1) - arm.y() * A.col(0);
    Eigen::Matrix3d SAS;  // skew(arm) * AS
    for (int k = 0; k < 3; ++k) SAS.col(k) = arm.cross(Eigen::Vector3d(AS.col(k)));
    const Eigen::Vector3d torque = arm.cross(Ar);
    sum.H.topLeftCorner<3, 3>() += w * A;
    sum.H.topRightCorner<3, 3>() += w * AS;
    sum.H.bottomLeftCorner<3, 3>() += w * AS.transpose();
    sum.H.bottomRightCorner<3, 3>() += w * SAS;
    sum.b.head<3>() += w * Ar;
    sum.b.tail<3>() += w * torque;
    if constexpr (turns) {
      const auto s = static_cast<double>(source_.times[i]);
      sum.first.topRows<3>() += (w * s) * AS;
      sum.first.bottomRows<3>() += (w * s) * SAS;
      sum.second += (w * s * s) * SAS;
      sum.b_turn += (w * s) * torque;
    }
    sum.weight += w;
    sum.squares += w * rAr;
    ++sum.count;
  }

  const VoxelMap& map_;
  const SweepPoints& source_;
  const RegistrationKernel& kernel_;
  Pose guess_;
  MapAnchor anchor_;
  Pose pose_;  // in the anchor's frame
  Eigen::Vector3d turn_ = Eigen::Vector3d::Zero();
  std::vector<Match> matches_;
};

}  // namespace

ScanRegistration register_scan(const VoxelMap& map, const SweepPoints& source, const Pose& guess,
                               const RegistrationKernel& kernel) {
  return Registration(map, source, guess, kernel).run();
}

double mean_distance(const VoxelMap& map, const Points& points, const Pose& T_world_scan,
                     double max_distance) {
  if (points.empty()) return max_distance;
  const MapAnchor anchor = map.anchor_at(T_world_scan.translation);
  const PoseF T(anchor.inside(T_world_scan));
  const auto limit = static_cast<float>(max_distance);
  const double sum =
      ordered_sum<double>(points.size(), kBlock, 0.0, [&](std::size_t begin, std::size_t end) {
        double part = 0.0;
        for (std::size_t i = begin; i < end; ++i) {
          const float squared = map.nearest(anchor, T * points[i], limit).squared_distance;
          part += static_cast<double>(std::min(limit, std::sqrt(squared)));
        }
        return part;
      });
  return sum / static_cast<double>(points.size());
}

}  // namespace groundloop
