#include "backend/evaluation/map_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "backend/registration/cell_moments.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {
namespace {

constexpr double kMinPoints = 20.0;
constexpr double kMinPointsAgain = 10.0;
constexpr double kThin = 0.1;      // m
constexpr double kFlatness = 0.2;  // across over along
constexpr double kNoise = 1e-4;    // m^2

// What one visit saw of a cell.
struct Visit {
  std::uint32_t first_tag = 0, last_tag = 0;
  CellMoments moments;
};

struct Cell {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();  // moments are about it
  std::vector<Visit> visits;
};

// Standard deviations, ascending.
Eigen::Vector3d deviations(const CellMoments& moments) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments.covariance(), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

class Measurer {
 public:
  explicit Measurer(double cell) : cell_(cell) {}

  void add_tile(const PointTiles& tiles, const PointTiles::Key& key) {
    VoxelTable index;
    std::vector<Cell> cells;
    const auto inverse = static_cast<float>(1.0 / cell_);
    tiles.for_each_chunk(key, [&](std::span<const TilePoint> points) {
      for (const TilePoint& point : points) {
        if (point.offset.cwiseAbs().maxCoeff() > 1e5F) continue;
        const Eigen::Vector3i voxel = voxel_of(point.offset, inverse);
        const auto next = static_cast<std::uint32_t>(cells.size());
        const std::uint32_t number = index.find_or_insert(voxel_key(voxel), next);
        if (number == next) cells.push_back({voxel.cast<float>() * static_cast<float>(cell_), {}});
        add(cells[number], point);
      }
    });
    for (const Cell& cell : cells) judge(cell);
  }

  [[nodiscard]] MapMeasures result() {
    MapMeasures measures;
    measures.cell_m = cell_;
    measures.points = points_;
    measures.planes = figures(all_);
    measures.revisited = figures(revisited_);
    if (entropy_points_ > 0.0) measures.entropy = entropy_sum_ / entropy_points_;
    if (candidates_ > 0)
      measures.judged_share = static_cast<double>(all_.size()) / static_cast<double>(candidates_);
    return measures;
  }

 private:
  void add(Cell& cell, const TilePoint& point) {
    ++points_;
    if (cell.visits.empty() || point.tag > cell.visits.back().last_tag + 1)
      cell.visits.push_back({point.tag, point.tag, {}});
    Visit& visit = cell.visits.back();
    visit.last_tag = point.tag;
    visit.moments.add(point.offset - cell.origin);
  }

  void judge(const Cell& cell) {
    CellMoments all;
    const Visit* largest = &cell.visits.front();
    int again = 0;
    for (const Visit& visit : cell.visits) {
      all += visit.moments;
      again += visit.moments.count() >= kMinPointsAgain ? 1 : 0;
      if (visit.moments.count() > largest->moments.count()) largest = &visit;
    }
    if (all.count() < kMinPoints) return;
    ++candidates_;
    const Eigen::Matrix3d covariance = all.covariance() + kNoise * Eigen::Matrix3d::Identity();
    entropy_points_ += all.count();
    entropy_sum_ += all.count() * 0.5 *
                    (3.0 * std::log(2.0 * std::numbers::pi * std::numbers::e) +
                     std::log(covariance.determinant()));
    if (largest->moments.count() < kMinPoints) return;
    const Eigen::Vector3d own = deviations(largest->moments);
    if (own[0] > kThin || own[0] > kFlatness * own[1]) return;
    const double thickness = deviations(all)[0];
    all_.push_back(thickness);
    if (again >= 2) revisited_.push_back(thickness);
  }

  static ThicknessFigures figures(std::vector<double> values) {
    ThicknessFigures result;
    result.cells = values.size();
    if (values.empty()) return result;
    std::sort(values.begin(), values.end());
    for (const double v : values) result.mean_m += v;
    result.mean_m /= static_cast<double>(values.size());
    result.most_m = values[std::min(values.size() - 1, values.size() * 95 / 100)];
    return result;
  }

  double cell_;
  std::size_t points_ = 0, candidates_ = 0;
  double entropy_sum_ = 0.0, entropy_points_ = 0.0;
  std::vector<double> all_, revisited_;
};

}  // namespace

MapMeasures measure_map(const PointTiles& tiles, double cell) {
  Measurer measurer(cell);
  for (const PointTiles::Key& key : tiles.keys()) measurer.add_tile(tiles, key);
  return measurer.result();
}

const char* map_measure_definitions() {
  return "thickness of a cell: rms distance of its points from their plane of least squares; a "
         "cell "
         "is a plane where the visit with most points in it (20 at least) deviates from one of its "
         "own by at most 0.1 m and a fifth of its smaller extent; revisited: two visits that do "
         "not "
         "follow one another have 10 points each; entropy: mean over points of 1/2 ln det(2 pi e "
         "C), "
         "C the covariance of the point's cell plus 1 cm^2";
}

}  // namespace groundloop
