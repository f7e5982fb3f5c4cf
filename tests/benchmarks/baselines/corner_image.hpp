// Points projected onto a plane, in pixels of 0.5 m: where STD and BTC look for key points.
#pragma once

#include <bitset>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace groundloop::baselines {

class CornerImage {
 public:
  CornerImage(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal);

  struct Pixel {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int points = 0;
    std::bitset<50> heights;  ///< occupied steps of `step` above `lowest`
  };
  /// Adds a point where its height above the plane (signed, or of either side) is in
  /// [lowest, highest).
  void add(const Eigen::Vector3d& point, double lowest, double highest, bool either_side);

  using Index = std::pair<int, int>;
  /// Nothing: zero.
  [[nodiscard]] int occupied_heights(const Index& index) const;
  [[nodiscard]] int points(const Index& index) const;
  [[nodiscard]] const std::map<Index, Pixel>& pixels() const { return pixels_; }
  /// Of each block of five by five pixels, from the lowest corner of the image on, the pixel with
  /// the greatest value, the first of equal ones.
  template <typename Value>
  [[nodiscard]] std::vector<Index> best_of_blocks(Value&& value) const;
  /// On the plane, at the mean of the pixel's points.
  [[nodiscard]] Eigen::Vector3d position(const Index& index) const;

 private:
  Eigen::Vector3d centre_, normal_, x_, y_;
  std::map<Index, Pixel> pixels_;
};

template <typename Value>
std::vector<CornerImage::Index> CornerImage::best_of_blocks(Value&& value) const {
  if (pixels_.empty()) return {};
  constexpr int kBlock = 5;
  int low_u = pixels_.begin()->first.first, low_v = pixels_.begin()->first.second;
  for (const auto& [index, pixel] : pixels_) {
    low_u = std::min(low_u, index.first);
    low_v = std::min(low_v, index.second);
  }
  std::map<Index, Index> best;
  for (const auto& [index, pixel] : pixels_) {
    const Index block{(index.first - low_u) / kBlock, (index.second - low_v) / kBlock};
    const auto [it, is_new] = best.try_emplace(block, index);
    if (!is_new && value(index) > value(it->second)) it->second = index;
  }
  std::vector<Index> result;
  for (const auto& [block, index] : best) result.push_back(index);
  return result;
}

}  // namespace groundloop::baselines
