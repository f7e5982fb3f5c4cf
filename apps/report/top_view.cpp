#include "apps/report/top_view.hpp"

#include <algorithm>
#include <cmath>

namespace groundloop::apps {

TopWindow window_around(const std::vector<Eigen::Vector3d>& positions, int longest) {
  constexpr double kFinest = 0.1;  // m a pixel
  Eigen::Vector2d low(0.0, 0.0);
  Eigen::Vector2d high(0.0, 0.0);
  bool any = false;
  for (const Eigen::Vector3d& p : positions) {
    if (!p.allFinite()) continue;
    low = any ? low.cwiseMin(p.head<2>()) : Eigen::Vector2d(p.head<2>());
    high = any ? high.cwiseMax(p.head<2>()) : Eigen::Vector2d(p.head<2>());
    any = true;
  }
  const double margin = std::clamp(0.12 * (high - low).maxCoeff(), 15.0, 60.0);
  low.array() -= margin;
  high.array() += margin;
  TopWindow window;
  window.low = low;
  window.pixel = std::max(kFinest, (high - low).maxCoeff() / longest);
  window.width = std::max(1, static_cast<int>(std::ceil((high - low).x() / window.pixel - 1e-6)));
  window.height = std::max(1, static_cast<int>(std::ceil((high - low).y() / window.pixel - 1e-6)));
  return window;
}

TopView::TopView(const TopWindow& window)
    : window_(window),
      pixels_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height)) {}

void TopView::add(const Eigen::Vector3f& position) {
  const double x = (static_cast<double>(position.x()) - window_.low.x()) / window_.pixel;
  const double y = (static_cast<double>(position.y()) - window_.low.y()) / window_.pixel;
  const double z = static_cast<double>(position.z()) * 20.0;
  if (!(x >= 0.0 && x < window_.width && y >= 0.0 && y < window_.height)) return;
  if (!(std::abs(z) < 32000.0)) return;
  const std::size_t row =
      static_cast<std::size_t>(window_.height) - 1 - static_cast<std::size_t>(y);
  Pixel& pixel =
      pixels_[row * static_cast<std::size_t>(window_.width) + static_cast<std::size_t>(x)];
  const auto height = static_cast<std::int16_t>(z);
  pixel.low = std::min(pixel.low, height);
  pixel.high = std::max(pixel.high, height);
}

GreyPicture TopView::draw() const {
  constexpr double kGround = 0.13;  // darkness of what is flat
  constexpr double kTall = 2.5;     // m, from which a thing is as dark as it gets
  constexpr int kGreys = 15;
  GreyPicture picture{window_.width, window_.height, {}};
  picture.pixels.reserve(pixels_.size());
  for (const Pixel& pixel : pixels_) {
    double ink = 0.0;
    if (pixel.low <= pixel.high) {
      const double tall = std::min(1.0, 0.05 * (pixel.high - pixel.low) / kTall);
      ink = kGround + (1.0 - kGround) * std::pow(tall, 0.8);
    }
    const double light = std::round((1.0 - ink) * kGreys) / kGreys;
    picture.pixels.push_back(static_cast<std::uint8_t>(std::lround(255.0 * light)));
  }
  return picture;
}

}  // namespace groundloop::apps
