#include "tests/benchmarks/baselines/stable_triangles.hpp"

#include <map>

#include "tests/benchmarks/baselines/corner_image.hpp"

namespace groundloop::baselines {
namespace {

constexpr std::size_t kCorners = 100, kLeastPoints = 10;
constexpr int kCornerPoints = 10;
constexpr double kMerge = 0.2, kProjectedAlike = 0.5;
constexpr double kLowest = 0.0, kHighest = 5.0;  // m from the plane

// The six voxels that touch one in a face.
std::vector<VoxelIndex> neighbours(const VoxelIndex& v) {
  return {{v[0] + 1, v[1], v[2]}, {v[0], v[1] + 1, v[2]}, {v[0], v[1], v[2] + 1},
          {v[0] - 1, v[1], v[2]}, {v[0], v[1] - 1, v[2]}, {v[0], v[1], v[2] - 1}};
}

// Whether a plane goes on in a neighbour.
bool goes_on(const PlaneVoxels& voxels, const VoxelIndex& index) {
  const FlatVoxel& plane = voxels.at(index).plane;
  for (const VoxelIndex& n : neighbours(index)) {
    const auto near = voxels.find(n);
    if (near != voxels.end() && near->second.is_plane &&
        parallel(plane.normal, near->second.plane.normal, kMerge)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<KeyPoint> border_corners(const PlaneVoxels& voxels) {
  std::vector<KeyPoint> corners;
  std::map<VoxelIndex, std::vector<Eigen::Vector3d>>
      projected;  // normals a voxel was projected along
  for (const auto& [index, voxel] : voxels) {
    if (voxel.is_plane || voxel.points.size() <= kLeastPoints) continue;
    for (const VoxelIndex& n : neighbours(index)) {
      const auto near = voxels.find(n);
      if (near == voxels.end() || !near->second.is_plane || !goes_on(voxels, n)) continue;
      const FlatVoxel& plane = near->second.plane;
      CornerImage image(plane.centre, plane.normal);
      for (long x = -1; x <= 1; ++x) {
        for (long y = -1; y <= 1; ++y) {
          for (long z = -1; z <= 1; ++z) {
            const VoxelIndex around{index[0] + x, index[1] + y, index[2] + z};
            const auto border = voxels.find(around);
            if (border == voxels.end() || border->second.is_plane) continue;
            std::vector<Eigen::Vector3d>& normals = projected[around];
            bool known = false;
            for (const Eigen::Vector3d& normal : normals) {
              known = known || parallel(normal, plane.normal, kProjectedAlike);
            }
            if (known) continue;
            normals.push_back(plane.normal);
            for (const Eigen::Vector3d& p : border->second.points) {
              image.add(p, kLowest, kHighest, true);
            }
          }
        }
      }
      for (const CornerImage::Index& best :
           image.best_of_blocks([&](const CornerImage::Index& i) { return image.points(i); })) {
        if (image.points(best) < kCornerPoints) continue;
        KeyPoint corner;
        corner.position = image.position(best);
        corner.strength = image.points(best);
        corners.push_back(corner);
      }
    }
  }
  return strongest(corners, kCorners);
}

bool alike_in_points(const Triangle& a, const Triangle& b) {
  Eigen::Vector3d p, q;
  for (std::size_t i = 0; i < 3; ++i) {
    p(static_cast<Eigen::Index>(i)) = a.corners[i].strength;
    q(static_cast<Eigen::Index>(i)) = b.corners[i].strength;
  }
  return 2.0 * (p - q).norm() / (p + q).norm() < 0.5;
}

MapPairs detect_by_std(const SessionScans& references, const SessionScans& queries) {
  return detect_by_triangles(
      references, queries,
      [](const std::vector<Eigen::Vector3d>&, const PlaneVoxels& voxels) {
        return triangles(border_corners(voxels), 0.0);
      },
      alike_in_points);
}

}  // namespace groundloop::baselines
