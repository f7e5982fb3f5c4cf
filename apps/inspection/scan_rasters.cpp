#include "apps/inspection/scan_rasters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace groundloop::apps {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

Raster empty_raster(std::size_t width, std::size_t height) {
  return {width, height, std::vector<float>(width * height, kNothing)};
}

// The column or row of a place that is a share of the whole; false where it lies outside.
bool cell(double share, std::size_t size, std::size_t& index) {
  if (!(share >= 0.0 && share < 1.0)) return false;
  index = static_cast<std::size_t>(share * static_cast<double>(size));
  return true;
}

double azimuth_deg(const Eigen::Vector3f& p) {
  return std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x())) * kDegrees;
}

double elevation_deg(const Eigen::Vector3f& p) {
  return std::atan2(static_cast<double>(p.z()),
                    std::hypot(static_cast<double>(p.x()), static_cast<double>(p.y()))) *
         kDegrees;
}

template <typename T>
T at_share(std::vector<T> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace

Raster seen_from_above(const Scan& scan, std::size_t width, std::size_t height, double half_m) {
  Raster raster = empty_raster(width, height);
  for (const Eigen::Vector3f& p : scan.points) {
    std::size_t column = 0, row = 0;
    if (!cell(0.5 - 0.5 * static_cast<double>(p.y()) / half_m, width, column) ||
        !cell(0.5 - 0.5 * static_cast<double>(p.x()) / half_m, height, row))
      continue;
    float& value = raster.values[row * width + column];
    value = std::isnan(value) ? p.z() : std::max(value, p.z());
  }
  return raster;
}

double usual_reach(const Scan& scan) {
  constexpr double kShare = 0.9, kStep = 5.0;
  std::vector<float> ranges;
  for (const Eigen::Vector3f& p : scan.points) ranges.push_back(p.head<2>().norm());
  if (ranges.empty()) return kStep;
  return kStep *
         std::max(1.0, std::ceil(static_cast<double>(at_share(std::move(ranges), kShare)) / kStep));
}

View view_of(const Scan& scan) {
  View view;
  if (scan.points.empty()) return view;
  std::array<bool, 360> seen{};
  std::vector<double> elevations;
  for (const Eigen::Vector3f& p : scan.points) {
    elevations.push_back(elevation_deg(p));
    seen[static_cast<std::size_t>(azimuth_deg(p) + 360.0) % 360U] = true;
  }
  view.bottom_deg = at_share(elevations, 0.002) - 0.5;
  view.top_deg = at_share(elevations, 0.998) + 0.5;
  // The widest sector without points lies outside of the picture.
  constexpr std::size_t kNarrowest = 60;
  std::size_t widest = 0, end = 0, run = 0;
  for (std::size_t i = 0; i < 720; ++i) {
    run = seen[i % 360] ? 0 : run + 1;
    if (run > widest && run < 360) {
      widest = run;
      end = i % 360;
    }
  }
  if (widest < kNarrowest) return view;
  // Points begin to the left of the sector's end and go round to its beginning.
  view.right_deg = static_cast<double>(end) + 1.0;
  if (view.right_deg > 180.0) view.right_deg -= 360.0;
  view.left_deg = view.right_deg + 360.0 - static_cast<double>(widest);
  return view;
}

Raster range_image(const Scan& scan, std::size_t width, std::size_t height, const View& view) {
  Raster raster = empty_raster(width, height);
  for (const Eigen::Vector3f& p : scan.points) {
    double azimuth = azimuth_deg(p);
    if (azimuth < view.right_deg) azimuth += 360.0;
    if (azimuth > view.left_deg && azimuth - 360.0 >= view.right_deg) azimuth -= 360.0;
    std::size_t column = 0, row = 0;
    if (!cell((view.left_deg - azimuth) / (view.left_deg - view.right_deg), width, column) ||
        !cell((view.top_deg - elevation_deg(p)) / (view.top_deg - view.bottom_deg), height, row))
      continue;
    float& value = raster.values[row * width + column];
    const float range = p.norm();
    value = std::isnan(value) ? range : std::min(value, range);
  }
  return raster;
}

std::vector<double> times_along(const Scan& scan, std::size_t width) {
  std::vector<double> along;
  if (scan.times.empty()) return along;
  const std::size_t parts = std::min(width, scan.times.size());
  for (std::size_t k = 0; k < parts; ++k) {
    const auto begin = static_cast<std::ptrdiff_t>(k * scan.times.size() / parts);
    const auto end = static_cast<std::ptrdiff_t>((k + 1) * scan.times.size() / parts);
    along.push_back(static_cast<double>(
        at_share(std::vector<float>(scan.times.begin() + begin, scan.times.begin() + end), 0.5)));
  }
  return along;
}

}  // namespace groundloop::apps
