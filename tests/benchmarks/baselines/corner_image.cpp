#include "tests/benchmarks/baselines/corner_image.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace groundloop::baselines {
namespace {

constexpr double kPixel = 0.5;  // m
constexpr double kStep = 0.1;   // m of height

}  // namespace

CornerImage::CornerImage(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal)
    : centre_(centre), normal_(normal) {
  // The horizontal axis of the plane that is nearest to the world's x, so that pixels lie alike in
  // every cloud of one odometry.
  const Eigen::Vector3d along =
      std::abs(normal.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  x_ = (along - along.dot(normal) * normal).normalized();
  y_ = normal.cross(x_);
}

void CornerImage::add(const Eigen::Vector3d& point, double lowest, double highest,
                      bool either_side) {
  const Eigen::Vector3d d = point - centre_;
  const double height = either_side ? std::abs(d.dot(normal_)) : d.dot(normal_);
  if (!(height >= lowest && height < highest)) return;
  const Eigen::Vector2d at(d.dot(x_), d.dot(y_));
  Pixel& pixel = pixels_[{static_cast<int>(std::floor(at.x() / kPixel)),
                          static_cast<int>(std::floor(at.y() / kPixel))}];
  pixel.sum += at;
  ++pixel.points;
  pixel.heights.set(std::min<std::size_t>(49, static_cast<std::size_t>((height - lowest) / kStep)));
}

int CornerImage::occupied_heights(const Index& index) const {
  const auto pixel = pixels_.find(index);
  return pixel == pixels_.end() ? 0 : static_cast<int>(pixel->second.heights.count());
}

int CornerImage::points(const Index& index) const {
  const auto pixel = pixels_.find(index);
  return pixel == pixels_.end() ? 0 : pixel->second.points;
}

Eigen::Vector3d CornerImage::position(const Index& index) const {
  const Pixel& pixel = pixels_.at(index);
  const Eigen::Vector2d mean = pixel.sum / pixel.points;
  return centre_ + mean.x() * x_ + mean.y() * y_;
}

}  // namespace groundloop::baselines
