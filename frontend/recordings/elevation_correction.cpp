#include "frontend/recordings/elevation_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "frontend/core/error.hpp"

namespace groundloop::recordings {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kBinDeg = 0.02;
constexpr std::size_t kBins = static_cast<std::size_t>(180.0 / kBinDeg);
constexpr std::size_t kSampledScans = 12;

using Histogram = std::array<std::size_t, kBins>;

double angle_at(const Histogram& histogram, std::size_t total, double share) {
  const double rank = share * static_cast<double>(total);
  std::size_t sum = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    sum += histogram[bin];
    if (static_cast<double>(sum) > rank) return (static_cast<double>(bin) + 0.5) * kBinDeg - 90.0;
  }
  return 90.0;
}

}  // namespace

void correct_elevation(Points& points, double degrees) {
  const auto c = static_cast<float>(std::cos(degrees * kDegree));
  const auto s = static_cast<float>(std::sin(degrees * kDegree));
  for (Eigen::Vector3f& p : points) {
    const float horizontal = std::sqrt(p.x() * p.x() + p.y() * p.y());
    if (horizontal == 0.0F) continue;  // straight up or down: no azimuth to keep
    const float scale = c - s * p.z() / horizontal;
    p = Eigen::Vector3f(p.x() * scale, p.y() * scale, c * p.z() + s * horizontal);
  }
}

SensorSignature sensor_signature(Recording& recording) {
  Histogram all{};
  Histogram far{};
  std::size_t all_total = 0, far_total = 0;
  const std::size_t samples = std::min(kSampledScans, recording.size());
  for (std::size_t k = 0; k < samples; ++k) {
    Scan scan;
    try {
      scan = recording.read(k * recording.size() / samples);
    } catch (const InputError&) {
      continue;  // the others tell
    }
    for (const Eigen::Vector3f& p : scan.points) {
      const double horizontal = std::hypot(static_cast<double>(p.x()), static_cast<double>(p.y()));
      const double elevation = std::atan2(static_cast<double>(p.z()), horizontal) / kDegree;
      const auto bin = std::min(kBins - 1, static_cast<std::size_t>((elevation + 90.0) / kBinDeg));
      ++all[bin];
      ++all_total;
      if (horizontal < 10.0) continue;  // nearer, a laser's place in the housing shifts its angle
      ++far[bin];
      ++far_total;
    }
  }
  SensorSignature signature;
  if (all_total < 2000 || far_total < 500) {
    signature.reason = "too few points to tell the sensor";
    return signature;
  }
  signature.lowest_deg = angle_at(all, all_total, 0.001);
  signature.highest_deg = angle_at(far, far_total, 0.999);
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "elevations from %.1f to %+.1f degrees",
                signature.lowest_deg, signature.highest_deg);
  signature.reason = text.data();
  signature.kitti_hdl64 = signature.lowest_deg > -26.5 && signature.lowest_deg < -22.0 &&
                          signature.highest_deg > 1.4 && signature.highest_deg < 4.0;
  return signature;
}

}  // namespace groundloop::recordings
