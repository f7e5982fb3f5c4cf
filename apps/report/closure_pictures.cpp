#include "apps/report/closure_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <png.h>

#include "frontend/core/error.hpp"
#include "loopclosure/density_image.hpp"
#include "loopclosure/ground_alignment.hpp"

namespace groundloop::apps {
namespace {

// Pixels [low, high) of the ground frame, both axes.
struct Window {
  Eigen::Vector2i low, high;
  [[nodiscard]] Eigen::Vector2i size() const { return high - low; }
  [[nodiscard]] bool empty() const { return (size().array() <= 0).any(); }
};

Window window_of(const DensityImage& image) {
  return {image.first_cell, image.first_cell + Eigen::Vector2i(image.width, image.height)};
}

// What either image shows, within `limit` pixels about the middle of what both show.
Window common_window(const Window& a, const Window& b, int limit) {
  const Eigen::Vector2i middle =
      (a.low.cwiseMax(b.low) + a.high.cwiseMin(b.high)).unaryExpr([](int v) { return v / 2; });
  return {a.low.cwiseMin(b.low).cwiseMax((middle.array() - limit / 2).matrix()),
          a.high.cwiseMax(b.high).cwiseMin((middle.array() + limit / 2).matrix())};
}

// Darkness in [0, 1] of a pixel of the ground frame. The square root lifts low walls, which are
// most of what an image holds.
double ink(const DensityImage& image, const Eigen::Vector2i& cell) {
  const Eigen::Vector2i at = cell - image.first_cell;
  if ((at.array() < 0).any() || at.x() >= image.width || at.y() >= image.height) return 0.0;
  const std::ptrdiff_t index = static_cast<std::ptrdiff_t>(at.y()) * image.width + at.x();
  return std::sqrt(image.pixels[static_cast<std::size_t>(index)] / 255.0);
}

std::vector<std::byte> to_png(const std::vector<std::uint8_t>& rgb, const Eigen::Vector2i& size) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(size.x());
  image.height = static_cast<png_uint_32>(size.y());
  image.format = PNG_FORMAT_RGB;
  std::vector<std::byte> png(PNG_IMAGE_PNG_SIZE_MAX(image));
  png_alloc_size_t bytes = png.size();
  const int written =
      png_image_write_to_memory(&image, png.data(), &bytes, 0, rgb.data(), 0, nullptr);
  check(written != 0, "a picture in memory can be written as PNG");
  png.resize(bytes);
  return png;
}

// Ink of the reference keeps back blue, that of the query red; both together leave little light.
std::vector<std::byte> draw(const Window& window, const DensityImage* reference,
                            const DensityImage* query) {
  const Eigen::Vector2i size = window.size();
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()));
  const auto level = [](double light) {
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(light, 0.0, 1.0)));
  };
  // Rows of a picture go down, y goes up.
  for (int y = window.high.y() - 1; y >= window.low.y(); --y) {
    for (int x = window.low.x(); x < window.high.x(); ++x) {
      const double r = reference != nullptr ? ink(*reference, {x, y}) : 0.0;
      const double q = query != nullptr ? ink(*query, {x, y}) : 0.0;
      rgb.insert(rgb.end(),
                 {level(1 - q - 0.1 * r), level(1 - 0.5 * r - 0.5 * q), level(1 - r - 0.2 * q)});
    }
  }
  return to_png(rgb, size);
}

Pose ground_of(const Points& points, const GroundAlignmentOptions& options) {
  return options.enabled ? align_to_ground(points, options).T_ground_map : Pose();
}

std::string caption_of(const ClosureRecord& closure) {
  std::string caption = "Maps " + std::to_string(closure.reference_map) + " and " +
                        std::to_string(closure.query_map) + ", ";
  return caption + (closure.source == ClosureSource::detector
                        ? std::to_string(closure.inliers) + " inliers"
                        : "found by their overlap");
}

}  // namespace

std::vector<ReportImage> closure_pictures(const std::vector<ClosureRecord>& closures,
                                          const std::function<Points(int map)>& points,
                                          const LoopClosureOptions& options,
                                          const ClosurePictureLimits& limits) {
  std::vector<const ClosureRecord*> accepted;
  for (const ClosureRecord& closure : closures) {
    if (closure.status == ClosureStatus::accepted) accepted.push_back(&closure);
  }
  const std::size_t count = std::min(limits.closures, accepted.size());
  const auto side = static_cast<int>(std::lround(limits.extent / options.density_image.resolution));
  std::vector<ReportImage> pictures;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const ClosureRecord& closure = *accepted[i * accepted.size() / count];
    const Points reference_points = points(closure.reference_map);
    const Points query_points = points(closure.query_map);
    if (reference_points.empty() || query_points.empty()) continue;
    const Pose T_ground_reference = ground_of(reference_points, options.ground_alignment);
    const Pose T_ground_query = T_ground_reference * closure.T_query_reference.inverse();
    const DensityImage reference =
        make_density_image(reference_points, T_ground_reference, options.density_image);
    const DensityImage query =
        make_density_image(query_points, T_ground_query, options.density_image);
    const Window window = common_window(window_of(reference), window_of(query), side);
    if (window.empty()) continue;
    ReportImage picture{caption_of(closure),
                        {draw(window, &reference, nullptr), draw(window, nullptr, &query),
                         draw(window, &reference, &query)}};
    for (const std::vector<std::byte>& png : picture.pngs) bytes += png.size();
    if (bytes > limits.bytes) break;
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace groundloop::apps
