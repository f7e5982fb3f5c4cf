#include "backend/refinement/surface_cells.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Eigenvalues>

#include "backend/registration/voxel_pyramid.hpp"

namespace groundloop {
namespace {

// Moments of points as a matrix: the sum of [p 1]' [p 1].
Eigen::Matrix4d homogeneous(const CellMoments& moments) {
  const std::array<double, 10>& m = moments.m;
  Eigen::Matrix4d sum;
  sum << m[4], m[5], m[6], m[1],  //
      m[5], m[7], m[8], m[2],     //
      m[6], m[8], m[9], m[3],     //
      m[1], m[2], m[3], m[0];
  return sum;
}

// Parts of the same submap as one.
std::vector<SurfacePart> merged(std::vector<SurfacePart> parts) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const SurfacePart& a, const SurfacePart& b) { return a.submap < b.submap; });
  std::vector<SurfacePart> result;
  for (const SurfacePart& part : parts) {
    if (!result.empty() && result.back().submap == part.submap) {
      result.back().moments += part.moments;
      result.back().towards_sensor += part.towards_sensor;
    } else {
      result.push_back(part);
    }
  }
  return result;
}

bool is_surface(const SurfaceFit& fit, const SurfaceCellOptions& options) {
  return fit.points >= options.min_points && fit.thickness() <= options.max_thickness &&
         fit.thickness() <= options.flatness * fit.deviations[1];
}

}  // namespace

SurfaceFit fit_surface(const std::vector<SurfacePart>& parts,
                       const std::vector<Pose>& T_world_submap) {
  SurfaceFit fit;
  // About the first part's place, so that nothing is lost far from the origin.
  const Eigen::Vector3d origin = T_world_submap[parts.front().submap].translation;
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const SurfacePart& part : parts) {
    Eigen::Matrix4d T = T_world_submap[part.submap].matrix();
    T.topRightCorner<3, 1>() -= origin;
    sum += T * homogeneous(part.moments) * T.transpose();
  }
  fit.points = sum(3, 3);
  const Eigen::Vector3d mean = sum.topRightCorner<3, 1>() / fit.points;
  const Eigen::Matrix3d covariance =
      sum.topLeftCorner<3, 3>() / fit.points - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  fit.centre = origin + mean;
  fit.normal = solver.eigenvectors().col(0);
  fit.deviations = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return fit;
}

SurfaceCells::SurfaceCells(const SurfaceCellOptions& options, std::vector<Pose> T_world_submap)
    : options_(options), T_world_submap_(std::move(T_world_submap)) {
  validate(options, "surfaces");
}

void SurfaceCells::add(int submap, const Pose& T_submap_scan, const Points& scan) {
  const PoseF T(T_submap_scan);
  // Cells are of the world, about the first submap, where single precision holds.
  const Pose T_cells_submap = T_world_submap_.front().inverse() * T_world_submap_[submap];
  const PoseF T_cells(T_cells_submap);
  const auto inverse_size = static_cast<float>(1.0 / options_.finest);
  for (const Eigen::Vector3f& point : scan) {
    const Eigen::Vector3f in_submap = T * point;
    const Eigen::Vector3f in_cells = T_cells * in_submap;
    if (!has_voxel(in_cells)) continue;
    const Eigen::Vector3i voxel = voxel_of(in_cells, inverse_size);
    const auto next = static_cast<std::uint32_t>(cells_.size());
    const std::uint32_t number = index_.find_or_insert(voxel_key(voxel), next);
    if (number == next) cells_.push_back({voxel, {}});
    std::vector<SurfacePart>& parts = cells_[number].parts;
    if (parts.empty() || parts.back().submap != submap) parts.push_back({submap, {}, {0, 0, 0}});
    parts.back().moments.add(in_submap);
    const float range = point.norm();
    if (range > 0.0F) parts.back().towards_sensor += (T.rotation * (-point / range)).cast<double>();
  }
}

// One surface or two from the cells of one cube, or none: then those of its eighths.
void SurfaceCells::add_surfaces(const std::vector<const Cell*>& cells, int level,
                                std::vector<Surface>& surfaces) const {
  std::vector<SurfacePart> parts;
  for (const Cell* cell : cells) parts.insert(parts.end(), cell->parts.begin(), cell->parts.end());
  parts = merged(std::move(parts));
  if (parts.size() < 2) return;
  const SurfaceFit fit = fit_surface(parts, T_world_submap_);
  if (!is_surface(fit, options_)) {
    if (level == 0) return;
    std::map<std::array<int, 3>, std::vector<const Cell*>> eighths;
    const int shift = level - 1;
    for (const Cell* cell : cells) {
      eighths[{cell->voxel.x() >> shift, cell->voxel.y() >> shift, cell->voxel.z() >> shift}]
          .push_back(cell);
    }
    for (const auto& [place, eighth] : eighths) add_surfaces(eighth, level - 1, surfaces);
    return;
  }
  // By the side they were seen from. A part seen from within its own plane tells no side.
  std::array<Surface, 2> sides;
  for (const SurfacePart& part : parts) {
    const double cosine =
        fit.normal.dot(T_world_submap_[part.submap].rotation * part.towards_sensor) /
        part.moments.count();
    if (std::abs(cosine) < 0.02) continue;
    sides[cosine > 0.0 ? 0 : 1].parts.push_back(part);
  }
  for (Surface& side : sides) {
    if (side.parts.size() < 2) continue;
    if (is_surface(fit_surface(side.parts, T_world_submap_), options_))
      surfaces.push_back(std::move(side));
  }
}

std::vector<Surface> SurfaceCells::surfaces() const {
  const int level = options_.levels - 1;
  VoxelTable index(cells_.size() / 8);
  std::vector<std::vector<const Cell*>> cubes;
  for (const Cell& cell : cells_) {
    const Eigen::Vector3i place(cell.voxel.x() >> level, cell.voxel.y() >> level,
                                cell.voxel.z() >> level);
    const auto next = static_cast<std::uint32_t>(cubes.size());
    const std::uint32_t number = index.find_or_insert(voxel_key(place), next);
    if (number == next) cubes.emplace_back();
    cubes[number].push_back(&cell);
  }
  std::vector<Surface> result;
  for (const auto& cube : cubes) add_surfaces(cube, level, result);
  return result;
}

}  // namespace groundloop
