#include "backend/column_agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "backend/voxel_pyramid.hpp"

namespace groundloop {
namespace {

constexpr float kColumn = 1.0F;
// Above kerbs and grass, below cars.
constexpr float kTall = 1.0F;
constexpr std::uint32_t kMinPoints = 3;
// Fewer columns of a kind than this share (or number) say nothing.
constexpr double kMinShare = 0.02;
constexpr double kMinColumns = 30.0;

}  // namespace

bool ColumnGrid::Column::tall() const { return high - low > kTall; }
bool ColumnGrid::Column::seen() const { return points >= kMinPoints; }

ColumnGrid::ColumnGrid(const Points& points, const Pose& T_map_points, const Eigen::Vector3f& up)
    : index_(points.size() / 8) {
  Pose upright;
  upright.rotation =
      Eigen::Quaterniond::FromTwoVectors(up.cast<double>(), Eigen::Vector3d::UnitZ());
  const PoseF T(upright * T_map_points);
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f q = T * p;
    if (!has_voxel(q)) continue;
    Eigen::Vector3i cell = voxel_of(q, 1.0F / kColumn);
    cell.z() = 0;
    const VoxelKey key = voxel_key(cell);
    const auto next = static_cast<std::uint32_t>(columns_.size());
    const std::uint32_t number = index_.find_or_insert(key, next);
    if (number == next) columns_.push_back({key, q.z(), q.z(), 0});
    Column& column = columns_[number];
    column.low = std::min(column.low, q.z());
    column.high = std::max(column.high, q.z());
    ++column.points;
  }
}

ColumnAgreement ColumnGrid::agreement(const ColumnGrid& other) const {
  std::array<std::array<double, 2>, 2> count{};
  for (const Column& column : columns_) {
    if (!column.seen()) continue;
    const std::uint32_t number = other.index_.find(column.key);
    if (number == VoxelTable::kNone || !other.columns_[number].seen()) continue;
    count[column.tall() ? 1 : 0][other.columns_[number].tall() ? 1 : 0] += 1.0;
  }
  const double tall = count[1][0] + count[1][1];
  const double flat = count[0][0] + count[0][1];
  const double other_tall = count[0][1] + count[1][1];
  const double other_flat = count[0][0] + count[1][0];
  ColumnAgreement result;
  result.shared = static_cast<std::size_t>(tall + flat);
  const double least = std::max(kMinColumns, kMinShare * (tall + flat));
  result.defined = std::min({tall, flat, other_tall, other_flat}) >= least;
  if (result.defined) {
    result.correlation = (count[1][1] * count[0][0] - count[1][0] * count[0][1]) /
                         std::sqrt(tall * flat * other_tall * other_flat);
  }
  return result;
}

}  // namespace groundloop
