#include "backend/registration/column_agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "backend/registration/voxel_pyramid.hpp"

namespace groundloop {
namespace {

constexpr float kColumn = 1.0F;
// Above kerbs and grass, below cars.
constexpr float kTall = 1.0F;
constexpr std::uint32_t kMinPoints = 3;
// Fewer columns of a kind than this share (or number) say nothing.
constexpr double kMinShare = 0.02;
constexpr double kMinColumns = 30.0;

// Columns of each kind in the one map (first index) and the other; 1 is tall.
using Counts = std::array<std::array<double, 2>, 2>;

ColumnAgreement correlate(const Counts& count) {
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

// Where one map is moved to for a contrast, in columns. Nearer than this the same walls still meet.
constexpr int kNearest = 4;
constexpr int kFarthest = 20;
// A map wider than this is looked at in part.
constexpr int kWidest = 1024;

// Seen columns as a picture: moving it costs no search.
struct Picture {
  Eigen::Vector2i origin = Eigen::Vector2i::Zero();
  Eigen::Vector2i size = Eigen::Vector2i::Zero();
  std::vector<signed char> kind;  // -1 unseen, 0 flat, 1 tall
  [[nodiscard]] int at(const Eigen::Vector2i& cell) const {
    const Eigen::Vector2i p = cell - origin;
    if ((p.array() < 0).any() || (p.array() >= size.array()).any()) return -1;
    return kind[index(p)];
  }
  // Of a cell that lies inside, `p` cells from the origin.
  [[nodiscard]] std::size_t index(const Eigen::Vector2i& p) const {
    return static_cast<std::size_t>(p.y()) * static_cast<std::size_t>(size.x()) +
           static_cast<std::size_t>(p.x());
  }
};

Picture picture_of(const std::vector<std::pair<Eigen::Vector2i, bool>>& columns) {
  Picture picture;
  if (columns.empty()) return picture;
  Eigen::Vector2i high = picture.origin = columns.front().first;
  for (const auto& [cell, tall] : columns) {
    picture.origin = picture.origin.cwiseMin(cell);
    high = high.cwiseMax(cell);
  }
  picture.size = (high - picture.origin).array().min(kWidest - 1) + 1;
  picture.kind.assign(picture.index({0, picture.size.y()}), -1);
  for (const auto& [cell, tall] : columns) {
    const Eigen::Vector2i p = cell - picture.origin;
    if ((p.array() >= picture.size.array()).any()) continue;
    picture.kind[picture.index(p)] = tall ? 1 : 0;
  }
  return picture;
}

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
  Counts count{};
  for (const Column& column : columns_) {
    if (!column.seen()) continue;
    const std::uint32_t number = other.index_.find(column.key);
    if (number == VoxelTable::kNone || !other.columns_[number].seen()) continue;
    count[column.tall() ? 1 : 0][other.columns_[number].tall() ? 1 : 0] += 1.0;
  }
  return correlate(count);
}

std::vector<std::pair<Eigen::Vector2i, bool>> ColumnGrid::seen_columns() const {
  std::vector<std::pair<Eigen::Vector2i, bool>> seen;
  for (const Column& column : columns_) {
    if (column.seen()) seen.emplace_back(voxel_from_key(column.key).head<2>(), column.tall());
  }
  return seen;
}

ColumnContrast ColumnGrid::contrast(const ColumnGrid& other) const {
  const auto columns = seen_columns();
  const Picture picture = picture_of(other.seen_columns());
  const auto moved_by = [&](int x, int y) {
    Counts count{};
    for (const auto& [cell, tall] : columns) {
      const int kind = picture.at(cell - Eigen::Vector2i(x, y));
      if (kind >= 0) count[tall ? 1 : 0][static_cast<std::size_t>(kind)] += 1.0;
    }
    return correlate(count);
  };
  const ColumnAgreement here = agreement(other);
  ColumnContrast result{here.correlation, -1.0, here.defined};
  if (!result.defined) return result;
  for (int x = -kFarthest; x <= kFarthest; ++x) {
    for (int y = -kFarthest; y <= kFarthest; ++y) {
      const int squared = x * x + y * y;
      if (squared < kNearest * kNearest || squared > kFarthest * kFarthest) continue;
      result.beside = std::max(result.beside, moved_by(x, y).correlation);
    }
  }
  return result;
}

}  // namespace groundloop
