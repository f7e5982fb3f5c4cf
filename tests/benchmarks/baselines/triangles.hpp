// Triangles between key points, found by the lengths of their sides, and places verified by the
// planes that agree under a triangle's motion: what STD (Yuan et al., ICRA 2023) and BTC (Yuan et
// al., T-RO 2024) have in common. They differ in their key points and in what they compare of them.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "tests/benchmarks/baselines/plane_voxels.hpp"
#include "tests/benchmarks/baselines/session_scans.hpp"

namespace groundloop::baselines {

struct KeyPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double strength = 0;      ///< points (STD) or occupied heights (BTC)
  std::bitset<50> heights;  ///< BTC: which tenths of a metre above the plane are occupied
};

struct Triangle {
  std::array<KeyPoint, 3> corners;  ///< A, B, C: sides AB <= AC <= BC by the roles of their corners
  Eigen::Vector3d sides = Eigen::Vector3d::Zero();  ///< in fifths of a metre, ascending
  std::uint32_t frame = 0;
};

/// Removes key points with another as strong within 2 m, then all but the strongest.
[[nodiscard]] std::vector<KeyPoint> strongest(const std::vector<KeyPoint>& points,
                                              std::size_t most);

/// Triangles of each key point with two of its nine nearest, sides of 2 to 50 m, each once;
/// `least_height` (m): by how much the two shorter sides must exceed the longest.
[[nodiscard]] std::vector<Triangle> triangles(const std::vector<KeyPoint>& points,
                                              double least_height);

/// A few scans as one cloud, in the odometry's world.
struct Frame {
  std::vector<Triangle> triangles;
  std::vector<FlatVoxel> planes;
  std::size_t first_scan = 0, last_scan = 0;  ///< included
};

struct FrameMatch {
  std::uint32_t frame = 0;
  double score = 0.0;  ///< share of planes that agree
  Eigen::Matrix3d rotation =
      Eigen::Matrix3d::Identity();  ///< of the query's world to the reference's
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// Two triangles' key points look alike.
using AlikeTriangles = std::function<bool(const Triangle&, const Triangle&)>;

class TriangleDatabase {
 public:
  explicit TriangleDatabase(AlikeTriangles alike) : alike_(std::move(alike)) {}
  void insert(Frame frame);
  [[nodiscard]] const std::vector<Frame>& frames() const { return frames_; }
  /// The fifty frames with the most triangles alike, at least five, verified.
  [[nodiscard]] std::vector<FrameMatch> search(
      const Frame& query, const std::function<bool(const Frame&)>& eligible) const;

 private:
  using Match = std::pair<const Triangle*, const Triangle*>;  // query, reference
  [[nodiscard]] std::optional<FrameMatch> verify(const Frame& query, std::uint32_t frame,
                                                 const std::vector<Match>& matches) const;
  AlikeTriangles alike_;
  std::vector<Frame> frames_;
  std::map<std::array<int, 3>, std::vector<std::pair<std::uint32_t, std::uint32_t>>> cells_;
};

/// Clouds of ten scans each, described by `describe`, matched as both methods do.
[[nodiscard]] MapPairs detect_by_triangles(
    const SessionScans& references, const SessionScans& queries,
    const std::function<std::vector<Triangle>(const std::vector<Eigen::Vector3d>&,
                                              const PlaneVoxels&)>& describe,
    const AlikeTriangles& alike);

}  // namespace groundloop::baselines
