#include "loopclosure/ground_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "loopclosure/lowest_points.hpp"
#include "loopclosure/voxel_normals.hpp"
#include "loopclosure/wide.hpp"

namespace groundloop {
namespace {

constexpr float kMaxExtent = 512.0F;             // m along x and y; the sampling grid stays bounded
constexpr std::size_t kDirectionSamples = 2000;  // normals that candidate directions are sought in
constexpr std::size_t kMaxPoints = 100000;       // a plane needs no more
constexpr std::size_t kMinGroundCells = 20;
constexpr double kStopStep = 1e-6;  // m and rad

// The rotation about a horizontal axis that turns unit vector `n` upward to z.
Eigen::Quaterniond rotation_to_vertical(const Eigen::Vector3d& n) {
  const Eigen::Vector3d axis = n.cross(Eigen::Vector3d::UnitZ());
  const double sine = axis.norm();
  // Already vertical: the axis vanishes.
  if (sine < 1e-12) return Eigen::Quaterniond::Identity();
  return exp_so3(axis / sine * std::atan2(sine, n.z()));
}

// Largest eigenvector of the sum of n n' of the normals within the gate of `direction`, upward.
template <typename Normals>
Eigen::Vector3d principal_direction(const Normals& normals, const Eigen::Vector3d& direction,
                                    double gate) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& normal : normals) {
    const Eigen::Vector3d n = normal.template cast<double>();
    if (std::abs(n.dot(direction)) > gate) sum += n * n.transpose();
  }
  if (sum.isZero(0.0)) return direction;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
  const Eigen::Vector3d n = solver.eigenvectors().col(2);
  return n.dot(direction) < 0 ? Eigen::Vector3d(-n) : n;
}

// Directions evenly spread over the upper hemisphere (Fibonacci lattice), about 8 degrees apart.
std::vector<Eigen::Vector3d> hemisphere() {
  constexpr int kCount = 300;
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kCount; ++i) {
    const double z = (i + 0.5) / kCount;
    const double angle = i * 2.39996322972865332;
    const double r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

// How many unit vectors, one a row, lie within the gate of `direction` or its opposite.
GROUNDLOOP_WIDE std::size_t count_facing(const Eigen::MatrixX3f& normals,
                                         const Eigen::Vector3f& direction, float gate) {
  const float dx = direction.x(), dy = direction.y(), dz = direction.z();
  const float* const x = normals.col(0).data();
  const float* const y = normals.col(1).data();
  const float* const z = normals.col(2).data();
  const auto n = static_cast<std::int32_t>(normals.rows());
  std::int32_t count = 0;
  for (std::int32_t i = 0; i < n; ++i) {
    const float cosine = x[i] * dx + (y[i] * dy + z[i] * dz);
    count += (cosine > gate ? 1 : 0) + (cosine < -gate ? 1 : 0);
  }
  return static_cast<std::size_t>(count);
}

// Directions in which many voxels face, strongest first, with the share of sampled normals that
// face there.
struct Candidate {
  Eigen::Vector3d direction;
  double share;
};
std::vector<Candidate> candidate_directions(const VoxelNormals& voxels, double gate,
                                            std::size_t most) {
  std::vector<Eigen::Vector3f> normals;
  const std::size_t stride = std::max<std::size_t>(1, voxels.size() / kDirectionSamples);
  for (std::size_t i = 0; i < voxels.size(); i += stride) {
    if (const Eigen::Vector3f& n = voxels.normal(i); !n.isZero(0.0F)) normals.push_back(n);
  }
  const auto samples = static_cast<double>(std::max<std::size_t>(1, normals.size()));
  static const std::vector<Eigen::Vector3d> lattice = hemisphere();
  std::vector<Candidate> candidates;
  while (candidates.size() < most && !normals.empty()) {
    std::size_t best = 0, best_count = 0;
    Eigen::MatrixX3f columns(static_cast<Eigen::Index>(normals.size()), 3);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      columns.row(static_cast<Eigen::Index>(i)) = normals[i];
    }
    for (std::size_t d = 0; d < lattice.size(); ++d) {
      const std::size_t count =
          count_facing(columns, lattice[d].cast<float>(), static_cast<float>(gate));
      if (count > best_count) best = d, best_count = count;
    }
    if (static_cast<double>(best_count) < 0.02 * samples) break;
    Eigen::Vector3d direction = principal_direction(normals, lattice[best], gate);
    direction = principal_direction(normals, direction, gate);
    if (direction.z() < 0) direction = -direction;
    const std::size_t before = normals.size();
    std::erase_if(normals, [&](const Eigen::Vector3f& n) {
      const double cosine = std::abs(n.cast<double>().dot(direction));
      return cosine > gate || std::abs(n.cast<double>().dot(lattice[best])) > gate;
    });
    candidates.push_back({direction, static_cast<double>(before - normals.size()) / samples});
  }
  return candidates;
}

// The lowest voxel of each cell of a grid across one direction.
class LowestVoxels {
 public:
  LowestVoxels(const VoxelNormals& voxels, double cell_size)
      : voxels_(voxels), inverse_(static_cast<float>(1.0 / cell_size)) {}

  // Samples along the z axis of the frame `T` leads to.
  const std::vector<std::uint32_t>& sample(const Pose& T) {
    const PoseF transform(T);
    const std::size_t n = voxels_.size();
    points_.resize(n);
    Eigen::Array2f low = Eigen::Array2f::Constant(kMaxExtent), high = -low;
    for (std::size_t i = 0; i < n; ++i) {
      points_[i] = transform * voxels_.means()[i];
      low = low.min(points_[i].head<2>().array());
      high = high.max(points_[i].head<2>().array());
    }
    low = low.max(-kMaxExtent).min(kMaxExtent);
    high = high.max(-kMaxExtent).min(kMaxExtent);
    lowest_.clear();
    if (n == 0) return lowest_;
    const Eigen::Array2f first_cell = (low * inverse_).floor();
    const Eigen::Array2i size = (high * inverse_ - first_cell).cast<int>() + 1;
    grid_.assign(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()), kNone);
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3f& p = points_[i];
      if (std::abs(p.x()) > kMaxExtent || std::abs(p.y()) > kMaxExtent) continue;
      // Not below zero, so that truncation is the floor.
      const int u = static_cast<int>(p.x() * inverse_ - first_cell.x());
      const int v = static_cast<int>(p.y() * inverse_ - first_cell.y());
      std::uint32_t& cell = grid_[static_cast<std::size_t>(v) * static_cast<std::size_t>(size.x()) +
                                  static_cast<std::size_t>(u)];
      if (cell == kNone || p.z() < points_[cell].z()) cell = static_cast<std::uint32_t>(i);
    }
    for (const std::uint32_t cell : grid_) {
      if (cell != kNone) lowest_.push_back(cell);
    }
    return lowest_;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  const VoxelNormals& voxels_;
  float inverse_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint32_t> grid_;
  std::vector<std::uint32_t> lowest_;
};

// A direction with the voxels that support it as ground.
struct Hypothesis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  std::vector<std::uint32_t> ground;
  double score = -1;
};

// Samples the lowest voxels along `direction`, turns it to their principal normal, and again where
// it moved far enough for other voxels to be the lowest.
Hypothesis evaluate(const Eigen::Vector3d& start, const VoxelNormals& voxels, LowestVoxels& grid,
                    double gate) {
  Hypothesis result;
  result.direction = start;
  for (int pass = 0; pass < 3; ++pass) {
    const Pose T(rotation_to_vertical(result.direction), Eigen::Vector3d::Zero());
    const std::vector<std::uint32_t>& lowest = grid.sample(T);
    std::vector<Eigen::Vector3f> normals;
    normals.reserve(lowest.size());
    for (const std::uint32_t i : lowest) normals.push_back(voxels.normal(i));
    const Eigen::Vector3d before = result.direction;
    result.direction = principal_direction(normals, before, gate);
    result.ground.clear();
    for (std::size_t i = 0; i < lowest.size(); ++i) {
      if (std::abs(normals[i].cast<double>().dot(result.direction)) > gate) {
        result.ground.push_back(lowest[i]);
      }
    }
    if (before.dot(result.direction) > 0.9998) break;  // about one degree
  }
  // Facades and ground may face one way with as many cells; the map's own z axis then tips the
  // scale.
  result.score =
      static_cast<double>(result.ground.size()) * (0.7 + 0.3 * std::max(0.0, result.direction.z()));
  return result;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Weighted least squares on height, roll and pitch (eq. least-sq). The Jacobian of z' for a
// perturbation from the left is [0 0 1 y' -x' 0]; the paper prints x' and y' exchanged.
Pose refine(Pose T, const std::vector<Eigen::Vector3d>& ground,
            const GroundAlignmentOptions& options) {
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    std::vector<double> magnitudes;
    std::vector<Eigen::Vector3d> moved;
    moved.reserve(ground.size());
    magnitudes.reserve(ground.size());
    for (const Eigen::Vector3d& g : ground) {
      moved.push_back(T * g);
      magnitudes.push_back(std::abs(moved.back().z()));
    }
    const double scale = std::max(options.weight_scale, 1.4826 * median(std::move(magnitudes)));
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : moved) {
      const double weight = std::exp(-0.5 * p.z() * p.z() / (scale * scale));
      const Eigen::Vector3d J(1.0, p.y(), -p.x());
      H += weight * J * J.transpose();
      b += weight * J * p.z();
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(H);
    const Eigen::Vector3d step = -solver.solve(b);
    if (solver.info() != Eigen::Success || !step.allFinite()) break;
    T = Pose(exp_so3({step(1), step(2), 0.0}), {0.0, 0.0, step(0)}) * T;
    if (step.norm() < kStopStep) break;
  }
  return T;
}

// The paper's own: sampled along the map's z axis once, turned to the principal component of all
// normals.
Hypothesis along_own_axis(const VoxelNormals& voxels, LowestVoxels& grid, double gate) {
  const std::vector<std::uint32_t>& lowest = grid.sample(Pose());
  std::vector<Eigen::Vector3f> normals;
  for (const std::uint32_t i : lowest) normals.push_back(voxels.normal(i));
  Hypothesis result;
  result.direction = principal_direction(normals, Eigen::Vector3d::UnitZ(), -1.0);
  for (std::size_t i = 0; i < lowest.size(); ++i) {
    if (std::abs(normals[i].cast<double>().dot(result.direction)) > gate) {
      result.ground.push_back(lowest[i]);
    }
  }
  return result;
}

Hypothesis best_hypothesis(const VoxelNormals& voxels, LowestVoxels& grid,
                           const GroundAlignmentOptions& options) {
  if (options.directions == 1) return along_own_axis(voxels, grid, options.normal_gate);
  Hypothesis best;
  for (const Candidate& candidate : candidate_directions(
           voxels, options.normal_gate, static_cast<std::size_t>(options.directions))) {
    // No direction has more ground cells than voxels that face it.
    if (candidate.share * static_cast<double>(voxels.size()) * 1.5 < best.score) break;
    Hypothesis hypothesis = evaluate(candidate.direction, voxels, grid, options.normal_gate);
    if (hypothesis.score > best.score) best = std::move(hypothesis);
  }
  return best;
}

// Identity but for the height of the lowest voxels.
GroundAlignment without_ground(const VoxelNormals& voxels, LowestVoxels& grid) {
  GroundAlignment result;
  std::vector<double> heights;
  for (const std::uint32_t i : grid.sample(Pose())) {
    heights.push_back(static_cast<double>(voxels.means()[i].z()));
  }
  result.T_ground_map.translation.z() = -median(std::move(heights));
  return result;
}

}  // namespace

GroundAlignment align_to_ground(const Points& map_points, const GroundAlignmentOptions& options) {
  if (options.method == "lowest") return plane_of_lowest_points(map_points, options);
  const VoxelNormals voxels(map_points, options.cell_size, kMaxPoints);
  LowestVoxels grid(voxels, options.cell_size);
  const Hypothesis best = best_hypothesis(voxels, grid, options);
  if (best.ground.size() < kMinGroundCells) return without_ground(voxels, grid);

  GroundAlignment result;
  std::vector<Eigen::Vector3d> ground;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : best.ground) {
    ground.emplace_back(voxels.means()[i].cast<double>());
    mean += ground.back();
  }
  mean /= static_cast<double>(ground.size());
  const Eigen::Quaterniond R = rotation_to_vertical(best.direction);
  const Pose T_initial(R, {0.0, 0.0, -(R * mean).z()});
  result.T_ground_map = refine(T_initial, ground, options);

  // How much of the ground as it is now seen lies on the plane.
  const std::vector<std::uint32_t>& lowest = grid.sample(result.T_ground_map);
  const double tolerance = std::max(0.5, 2.0 * options.weight_scale);
  for (const std::uint32_t i : lowest) {
    const double z = (result.T_ground_map * voxels.means()[i].cast<double>().eval()).z();
    result.ground_cells += static_cast<std::size_t>(std::abs(z) < tolerance);
  }
  result.quality = static_cast<double>(result.ground_cells) /
                   static_cast<double>(std::max<std::size_t>(1, lowest.size()));
  if (result.quality < options.min_quality) return without_ground(voxels, grid);
  result.found = true;
  return result;
}

}  // namespace groundloop
