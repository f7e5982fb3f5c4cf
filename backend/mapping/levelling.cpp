#include "backend/mapping/levelling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/SparseCholesky>

namespace groundloop {
namespace {

constexpr int kReweightings = 5;
constexpr double kHeld = 1e12;
constexpr int kShared = 3;  // unknowns of all maps: bend, and the tilt of the whole

// A map's vertical as a tilt against the common one.
struct Node {
  std::size_t scan = 0;                                   // the middle one
  Eigen::Vector2d place = Eigen::Vector2d::Zero();        // m, horizontal, mean over the scans
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();         // rad: x and y of the upright vector
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  // of `tilt`
  double walk = 0.0;    // rad^2, variance of the random walk since the node before
  double weight = 1.0;  // of the robust kernel
};

double square(double x) { return x * x; }

// Componentwise median, normalised: the vertical that most maps agree on.
Eigen::Vector3d common_vertical(const std::vector<Eigen::Vector3d>& up) {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(up.size());
    for (const Eigen::Vector3d& v : up) values.push_back(v(axis));
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    result(axis) = *middle;
  }
  return result.normalized();
}

// Variance of the rotation about one axis from scan to scan, summed (odometry_information.hpp).
std::vector<double> walked(const Trajectory& odometry, const OdometryInformationOptions& drift) {
  std::vector<double> sum(odometry.size(), 0.0);
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    const Pose step = odometry[i - 1].pose.inverse() * odometry[i].pose;
    sum[i] = sum[i - 1] + odometry_covariance(step, drift)(3, 3);
  }
  return sum;
}

std::vector<Node> make_nodes(const Trajectory& odometry, const std::vector<LocalMapRecord>& maps,
                             const std::vector<MapVertical>& verticals,
                             const Eigen::Quaterniond& level, const std::vector<double>& walk,
                             const LevellingOptions& options) {
  std::vector<Node> nodes;
  for (std::size_t m = 0; m < maps.size(); ++m) {
    if (verticals[m].surfaces == 0 || verticals[m].information.isZero(0.0)) continue;
    Node node;
    node.scan = (maps[m].first_scan + maps[m].last_scan) / 2;
    for (std::size_t i = maps[m].first_scan; i <= maps[m].last_scan; ++i)
      node.place += (level * odometry[i].pose.translation).head<2>();
    node.place /= static_cast<double>(maps[m].last_scan + 1 - maps[m].first_scan);
    const Eigen::Quaterniond R = level * odometry[maps[m].first_scan].pose.rotation;
    node.tilt = (R * verticals[m].up).head<2>();
    const Eigen::Matrix3d turn = R.toRotationMatrix();
    const Eigen::Matrix3d turned = turn * verticals[m].information * turn.transpose();
    // Counted as fewer surfaces, and never surer than the scatter of whole maps.
    const Eigen::Matrix2d information = turned.topLeftCorner<2, 2>() / options.correlated_surfaces +
                                        1e-6 * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d covariance =
        information.inverse() +
        square(options.scatter_deg * M_PI / 180.0) * Eigen::Matrix2d::Identity();
    node.information = covariance.inverse();
    if (!nodes.empty()) node.walk = std::max(1e-12, walk[node.scan] - walk[nodes.back().scan]);
    nodes.push_back(node);
  }
  return nodes;
}

// What is not known beforehand, all as standard deviations.
struct Scales {
  double bend = 3e-5;    // rad/m
  double walk = 1.0;     // factor on odometry's stated drift
  double scatter = 1.0;  // factor on the stated errors of the verticals
};

struct Solution {
  bool found = false;
  double bend = 0.0;  // tilt = offset + bend * place + wandered
  double bend_variance = 0.0;
  std::vector<Eigen::Vector2d> wandered;  // of each node, zero at the first
  std::vector<Eigen::Vector2d> residual;
  double log_evidence = 0.0;  // of the scales, up to a constant
};

// Sparse normal equations, filled entry by entry.
class NormalEquations {
 public:
  explicit NormalEquations(int size) : b(Eigen::VectorXd::Zero(size)), size_(size) {}
  void add(int row, int column, double value) { triplets_.emplace_back(row, column, value); }
  // value * (x_i - x_j)^2
  void add_difference(int i, int j, double value) {
    add(i, i, value);
    add(j, j, value);
    add(i, j, -value);
    add(j, i, -value);
  }
  [[nodiscard]] Eigen::SparseMatrix<double> matrix() const {
    Eigen::SparseMatrix<double> A(size_, size_);
    A.setFromTriplets(triplets_.begin(), triplets_.end());
    return A;
  }
  Eigen::VectorXd b;

 private:
  int size_;
  std::vector<Eigen::Triplet<double>> triplets_;
};

// Linear least squares over what each node wandered, the bend and the offset; and, the model being
// Gaussian, the density of the verticals under these scales with all unknowns integrated out.
Solution solve(const std::vector<Node>& nodes, const Scales& scales) {
  const auto n = static_cast<int>(nodes.size());
  const int own = 2 * n;
  NormalEquations equations(own + kShared);
  double constant = 0.0;  // terms of the evidence that need no solution
  for (int k = 0; k < n; ++k) {
    const Node& node = nodes[k];
    const Eigen::Matrix2d W = node.weight / square(scales.scatter) * node.information;
    Eigen::Matrix<double, 2, 2 + kShared> J;
    J << 1, 0, node.place.x(), 1, 0, 0, 1, node.place.y(), 0, 1;
    const std::array<int, 2 + kShared> at{2 * k, 2 * k + 1, own, own + 1, own + 2};
    const Eigen::Matrix<double, 2 + kShared, 2 + kShared> H = J.transpose() * W * J;
    const Eigen::Matrix<double, 2 + kShared, 1> g = J.transpose() * W * node.tilt;
    for (int i = 0; i < 2 + kShared; ++i) {
      equations.b(at[i]) += g(i);
      for (int j = 0; j < 2 + kShared; ++j) equations.add(at[i], at[j], H(i, j));
    }
    constant += 0.5 * std::log(W.determinant()) - 0.5 * node.tilt.dot(W * node.tilt);
    for (int axis = 0; axis < 2; ++axis) {
      if (k == 0) {  // the offset takes what the first node has
        equations.add(axis, axis, kHeld);
        constant += 0.5 * std::log(kHeld);
      } else {
        const double w = 1.0 / (square(scales.walk) * node.walk);
        equations.add_difference(2 * k + axis, 2 * k - 2 + axis, w);
        constant += 0.5 * std::log(w);
      }
    }
  }
  equations.add(own, own, 1.0 / square(scales.bend));
  constant -= std::log(scales.bend);

  Solution solution;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(equations.matrix());
  if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() <= 0) return solution;
  const Eigen::VectorXd x = solver.solve(equations.b);
  solution.found = true;
  solution.bend = x(own);
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(own + kShared, own);
  solution.bend_variance = solver.solve(unit)(own);
  solution.log_evidence =
      constant + 0.5 * equations.b.dot(x) - 0.5 * solver.vectorD().array().log().sum();
  for (int k = 0; k < n; ++k) {
    solution.wandered.emplace_back(x.segment<2>(2 * k));
    solution.residual.emplace_back(nodes[k].tilt - x.segment<2>(2 * k) - x(own) * nodes[k].place -
                                   x.segment<2>(own + 1));
  }
  return solution;
}

// The scales of greatest evidence.
Scales find_scales(const std::vector<Node>& nodes) {
  Scales best;
  double evidence = -std::numeric_limits<double>::infinity();
  for (const double bend : {1e-7, 1e-5, 3e-5, 1e-4, 3e-4}) {
    for (const double walk : {0.03, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.5, 4.0}) {
      for (const double scatter : {0.5, 0.7, 1.0, 1.4, 2.0, 3.0}) {
        const Scales scales{bend, walk, scatter};
        const Solution solution = solve(nodes, scales);
        if (!solution.found || solution.log_evidence <= evidence) continue;
        best = scales;
        evidence = solution.log_evidence;
      }
    }
  }
  return best;
}

// Geman-McClure on the normalised error, so that a map of leaning things does not bend the rest.
void reweight(const Solution& solution, double scatter, std::vector<Node>& nodes) {
  constexpr double kScale = 9.21;  // chi-square of 2 degrees of freedom at 99 per cent
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const double error =
        solution.residual[k].dot(nodes[k].information * solution.residual[k]) / square(scatter);
    nodes[k].weight = square(kScale / (kScale + error));
  }
}

// Tilt of each scan: the bend at its place, and what wandered between the nodes' scans.
std::vector<Eigen::Vector2d> tilts(const Trajectory& odometry, const std::vector<Node>& nodes,
                                   const Solution& solution, const Eigen::Quaterniond& level,
                                   const std::vector<double>& walk) {
  const std::vector<Eigen::Vector2d>& wandered = solution.wandered;
  std::vector<Eigen::Vector2d> result;
  std::size_t after = 0;
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    while (after < nodes.size() && nodes[after].scan <= i) ++after;
    Eigen::Vector2d tilt = wandered[after == 0 ? 0 : after - 1];
    if (after > 0 && after < nodes.size()) {
      const double whole = walk[nodes[after].scan] - walk[nodes[after - 1].scan];
      const double s = whole > 0 ? (walk[i] - walk[nodes[after - 1].scan]) / whole : 0.0;
      tilt += s * (wandered[after] - tilt);
    }
    result.emplace_back(tilt +
                        solution.bend * (level * odometry[i].pose.translation).head<2>().eval());
  }
  return result;
}

// Turns every pose back by its tilt against the first one's, and walks the same steps again.
Trajectory unbend(const Trajectory& odometry, const std::vector<Eigen::Vector2d>& tilt,
                  const Eigen::Quaterniond& level) {
  Trajectory result = odometry;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    const Eigen::Vector2d t = tilt[i] - tilt[0];
    // An upright vector leaning by (tx, ty) was turned by (-ty, tx, 0).
    const Eigen::Quaterniond back = exp_so3({t.y(), -t.x(), 0.0});
    const Eigen::Quaterniond R = level.conjugate() * back * level * odometry[i].pose.rotation;
    const Eigen::Vector3d step = odometry[i - 1].pose.rotation.conjugate() *
                                 (odometry[i].pose.translation - odometry[i - 1].pose.translation);
    result[i].pose = Pose(R, result[i - 1].pose.translation + result[i - 1].pose.rotation * step);
  }
  return result;
}

}  // namespace

Levelling level_odometry(const Trajectory& odometry, const std::vector<LocalMapRecord>& maps,
                         const std::vector<MapVertical>& verticals,
                         const OdometryInformationOptions& drift, const LevellingOptions& options) {
  Levelling result;
  result.odometry = odometry;
  std::vector<Eigen::Vector3d> up;
  for (std::size_t m = 0; m < maps.size(); ++m) {
    if (!verticals[m].information.isZero(0.0))
      up.emplace_back(odometry[maps[m].first_scan].pose.rotation * verticals[m].up);
  }
  result.maps = up.size();
  if (!options.enabled || up.size() < static_cast<std::size_t>(options.min_maps)) return result;

  const Eigen::Quaterniond level =
      Eigen::Quaterniond::FromTwoVectors(common_vertical(up), Eigen::Vector3d::UnitZ());
  const std::vector<double> walk = walked(odometry, drift);
  std::vector<Node> nodes = make_nodes(odometry, maps, verticals, level, walk, options);
  Scales scales;
  Solution solution;
  for (int i = 0; i < kReweightings; ++i) {
    if (i % 2 == 0) scales = find_scales(nodes);
    solution = solve(nodes, scales);
    if (!solution.found) return result;
    reweight(solution, scales.scatter, nodes);
  }
  double squares = 0.0;
  double weights = 0.0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    squares += nodes[k].weight * solution.residual[k].squaredNorm() / 2;
    weights += nodes[k].weight;
  }
  result.applied = true;
  result.bend = -solution.bend;  // in a bowl the upright leans inward
  result.bend_deviation = std::sqrt(solution.bend_variance);
  result.walk_scale = scales.walk;
  result.scatter = std::sqrt(squares / weights);
  result.odometry = unbend(odometry, tilts(odometry, nodes, solution, level, walk), level);
  return result;
}

}  // namespace groundloop
