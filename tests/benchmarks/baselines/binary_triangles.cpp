#include "tests/benchmarks/baselines/binary_triangles.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "tests/benchmarks/baselines/corner_image.hpp"

namespace groundloop::baselines {
namespace {

constexpr std::size_t kCorners = 500;
constexpr int kLeastHeights = 10;
constexpr double kMergeNormals = 0.1, kMergeDistance = 0.3;
constexpr double kLowest = -1.0, kHighest = 4.0;  // m above the plane
constexpr double kSimilarity = 0.7;
constexpr double kLeastExcess = 0.2;  // m, of two sides over the third: no triangle of a line

bool lie_in_each_other(const FlatVoxel& a, const FlatVoxel& b) {
  return parallel(a.normal, b.normal, kMergeNormals) &&
         std::abs(a.normal.dot(b.centre - a.centre)) < kMergeDistance &&
         std::abs(b.normal.dot(a.centre - b.centre)) < kMergeDistance;
}

// Joins planes that lie in one another, as its authors do: each new one takes the group of the
// first that it meets; groups that meet later stay apart. Planes without any stay only if asked to.
std::vector<FlatVoxel> merged(const std::vector<FlatVoxel>& planes, bool keep_single) {
  std::vector<int> group(planes.size(), 0);
  int next = 1;
  for (std::size_t i = planes.size(); i-- > 1;) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!lie_in_each_other(planes[i], planes[j])) continue;
      if (group[i] == 0 && group[j] == 0) {
        group[i] = group[j] = next++;
      } else if (group[i] == 0) {
        group[i] = group[j];
      } else if (group[j] == 0) {
        group[j] = group[i];
      }
    }
  }
  std::vector<FlatVoxel> result;
  std::map<int, std::size_t> place;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (group[i] == 0) {
      if (keep_single) result.push_back(planes[i]);
      continue;
    }
    const auto [it, is_new] = place.try_emplace(group[i], result.size());
    if (is_new) {
      result.push_back(planes[i]);
    } else {
      result[it->second] = joined(result[it->second], planes[i]);
    }
  }
  return result;
}

// Whether a pixel is part of a wall: along some direction its neighbours are about as full.
bool on_a_line(const CornerImage& image, const CornerImage::Index& at) {
  constexpr std::array<std::pair<int, int>, 4> kDirections{{{0, 1}, {1, 0}, {1, 1}, {1, -1}}};
  const int own = image.occupied_heights(at);
  for (const auto& [u, v] : kDirections) {
    const int a = image.occupied_heights({at.first + u, at.second + v});
    const int b = image.occupied_heights({at.first - u, at.second - v});
    if ((a >= own - 3 && 2 * b >= own) || (b >= own - 3 && 2 * a >= own) ||
        (a >= own - 3 && b >= own - 3)) {
      return true;
    }
  }
  return false;
}

double similarity(const KeyPoint& a, const KeyPoint& b) {
  return 2.0 * static_cast<double>((a.heights & b.heights).count()) /
         static_cast<double>(a.heights.count() + b.heights.count());
}

}  // namespace

FlatVoxel largest_plane(const PlaneVoxels& voxels, const Eigen::Vector3d& point) {
  std::vector<FlatVoxel> planes = merged(planes_of(voxels), false);
  const auto more = [](const FlatVoxel& a, const FlatVoxel& b) { return a.points > b.points; };
  std::stable_sort(planes.begin(), planes.end(), more);
  planes = merged(planes, true);
  std::stable_sort(planes.begin(), planes.end(), more);
  FlatVoxel ground;
  ground.centre = point;
  if (!planes.empty()) ground = planes.front();
  if (ground.normal.z() < 0) ground.normal = -ground.normal;
  return ground;
}

std::vector<KeyPoint> height_corners(const std::vector<Eigen::Vector3d>& cloud,
                                     const FlatVoxel& ground) {
  CornerImage image(ground.centre, ground.normal);
  for (const Eigen::Vector3d& p : cloud) image.add(p, kLowest, kHighest, false);
  std::vector<KeyPoint> corners;
  const auto heights = [&](const CornerImage::Index& i) { return image.occupied_heights(i); };
  for (const CornerImage::Index& best : image.best_of_blocks(heights)) {
    if (heights(best) < kLeastHeights || on_a_line(image, best)) continue;
    KeyPoint corner;
    corner.position = image.position(best);
    corner.strength = heights(best);
    corner.heights = image.pixels().at(best).heights;
    corners.push_back(corner);
  }
  return strongest(corners, kCorners);
}

bool alike_in_heights(const Triangle& a, const Triangle& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += similarity(a.corners[i], b.corners[i]);
  return sum / 3 > kSimilarity;
}

MapPairs detect_by_btc(const SessionScans& references, const SessionScans& queries) {
  return detect_by_triangles(
      references, queries,
      [](const std::vector<Eigen::Vector3d>& cloud, const PlaneVoxels& voxels) {
        if (cloud.empty()) return std::vector<Triangle>();
        return triangles(height_corners(cloud, largest_plane(voxels, cloud.front())), kLeastExcess);
      },
      alike_in_heights);
}

}  // namespace groundloop::baselines
