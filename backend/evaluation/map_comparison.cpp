#include "backend/evaluation/map_comparison.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <nanoflann.hpp>

#include "backend/registration/cell_moments.hpp"
#include "backend/registration/voxel_pyramid.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr double kVoxelPoints = 30.0;
constexpr std::size_t kBlock = 4096;

// Nearest points by nanoflann.
class NearestPoints {
 public:
  explicit NearestPoints(const Points& points) : cloud_{points}, tree_(3, cloud_, {20}) {}

  /// Squared distance and place of the nearest point.
  [[nodiscard]] std::pair<float, std::size_t> nearest(const Eigen::Vector3f& point) const {
    std::size_t place = 0;
    float squared = 0.0F;
    nanoflann::KNNResultSet<float> result(1);
    result.init(&place, &squared);
    tree_.findNeighbors(result, point.data(), {});
    return {squared, place};
  }

 private:
  struct Cloud {
    const Points& points;
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t k) const {
      return points[i][static_cast<Eigen::Index>(k)];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3> tree_;
};

struct Distances {
  double sum = 0.0, squares = 0.0, matched = 0.0;
  Distances& operator+=(const Distances& o) {
    sum += o.sum;
    squares += o.squares;
    matched += o.matched;
    return *this;
  }
};

Distances distances(const Points& from, const NearestPoints& to, double limit) {
  return ordered_sum(from.size(), kBlock, Distances{}, [&](std::size_t begin, std::size_t end) {
    Distances d;
    for (std::size_t i = begin; i < end; ++i) {
      const auto squared = static_cast<double>(to.nearest(from[i]).first);
      if (squared > limit * limit) continue;
      d.sum += std::sqrt(squared);
      d.squares += squared;
      d.matched += 1.0;
    }
    return d;
  });
}

struct Voxels {
  VoxelTable index;
  std::vector<Eigen::Vector3i> places;
  std::vector<CellMoments> moments;  // about the voxel's corner
};

Voxels voxels_of(const Points& points, double size) {
  Voxels voxels;
  const auto inverse = static_cast<float>(1.0 / size);
  for (const Eigen::Vector3f& point : points) {
    if (!has_voxel(point)) continue;
    const Eigen::Vector3i place = voxel_of(point, inverse);
    const auto next = static_cast<std::uint32_t>(voxels.moments.size());
    const std::uint32_t number = voxels.index.find_or_insert(voxel_key(place), next);
    if (number == next) {
      voxels.moments.emplace_back();
      voxels.places.push_back(place);
    }
    voxels.moments[number].add(point - place.cast<float>() * static_cast<float>(size));
  }
  return voxels;
}

Eigen::Matrix3d square_root(const Eigen::Matrix3d& m) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

}  // namespace

double wasserstein_squared(const Eigen::Vector3d& mean_a, const Eigen::Matrix3d& cov_a,
                           const Eigen::Vector3d& mean_b, const Eigen::Matrix3d& cov_b) {
  const Eigen::Matrix3d root = square_root(cov_a);
  const Eigen::Matrix3d both = square_root(root * cov_b * root);
  return (mean_a - mean_b).squaredNorm() +
         std::max(0.0, cov_a.trace() + cov_b.trace() - 2.0 * both.trace());
}

MapComparison compare_maps(const Points& map, const Points& truth, double limit, double voxel) {
  MapComparison result;
  result.limit_m = limit;
  result.voxel_m = voxel;
  if (map.empty() || truth.empty()) return result;
  const Distances to_truth = distances(map, NearestPoints(truth), limit);
  const Distances to_map = distances(truth, NearestPoints(map), limit);
  result.matched_share = to_truth.matched / static_cast<double>(map.size());
  result.completeness = to_map.matched / static_cast<double>(truth.size());
  if (to_truth.matched > 0.0 && to_map.matched > 0.0) {
    result.mean_distance_m = to_truth.sum / to_truth.matched;
    result.accuracy_m = std::sqrt(to_truth.squares / to_truth.matched);
    result.chamfer_m = 0.5 * (result.mean_distance_m + to_map.sum / to_map.matched);
  }
  const Voxels of_map = voxels_of(map, voxel);
  const Voxels of_truth = voxels_of(truth, voxel);
  for (std::size_t v = 0; v < of_map.moments.size(); ++v) {
    const CellMoments& a = of_map.moments[v];
    const std::uint32_t other = of_truth.index.find(voxel_key(of_map.places[v]));
    if (other == VoxelTable::kNone || a.count() < kVoxelPoints) continue;
    const CellMoments& b = of_truth.moments[other];
    if (b.count() < kVoxelPoints) continue;
    result.wasserstein_m +=
        std::sqrt(wasserstein_squared(a.mean(), a.covariance(), b.mean(), b.covariance()));
    ++result.voxels;
  }
  if (result.voxels > 0) result.wasserstein_m /= static_cast<double>(result.voxels);
  return result;
}

Pose align_maps(const Points& map, const Points& truth, const Pose& guess, double limit) {
  constexpr std::size_t kMost = 200'000;
  constexpr int kIterations = 50;
  const std::size_t step = std::max<std::size_t>(1, map.size() / kMost);
  const NearestPoints tree(truth);
  Pose pose = guess;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Vector3d mean_map = Eigen::Vector3d::Zero();
    Eigen::Vector3d mean_truth = Eigen::Vector3d::Zero();
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
    for (std::size_t i = 0; i < map.size(); i += step) {
      const Eigen::Vector3d moved = pose * Eigen::Vector3d(map[i].cast<double>());
      const auto [squared, place] = tree.nearest(moved.cast<float>());
      if (static_cast<double>(squared) > limit * limit) continue;
      pairs.emplace_back(moved, truth[place].cast<double>());
      mean_map += moved;
      mean_truth += pairs.back().second;
    }
    if (pairs.size() < 10) break;
    mean_map /= static_cast<double>(pairs.size());
    mean_truth /= static_cast<double>(pairs.size());
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const auto& [a, b] : pairs) sum += (b - mean_truth) * (a - mean_map).transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign = Eigen::Vector3d::Ones();
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign[2] = -1.0;
    const Eigen::Matrix3d R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    const Pose step_pose(R, Eigen::Vector3d(mean_truth - R * mean_map));
    pose = step_pose * pose;
    if (log_se3(step_pose).tail<3>().norm() < 1e-7 &&
        (R * mean_map + step_pose.translation - mean_map).norm() < 1e-5)
      break;
  }
  return pose;
}

}  // namespace groundloop
