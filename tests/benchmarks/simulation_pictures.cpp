// Draws what a recording looks like to loop closing, and prints its statistics: a scan, a local map
// from above and its density image beside each other. Local maps are built at ground truth, so that
// simulated and real recordings compare without odometry's errors.
//
//   groundloop_simulation_pictures RECORDING [PICTURE.png] [--thickness]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "frontend/core/error.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "frontend/simulation/simulation.hpp"
#include "loopclosure/density_image.hpp"
#include "loopclosure/features.hpp"
#include "loopclosure/ground_alignment.hpp"
#include "tests/support/wall_thickness.hpp"

namespace groundloop {
namespace {

constexpr int panel = 320;  // pixels

/// Low is blue, high is red.
cv::Vec3b colour(double height) {
  const double t = std::clamp((height + 1.0) / 8.0, 0.0, 1.0);
  const auto channel = [&](double middle) {
    return static_cast<unsigned char>(255.0 *
                                      std::clamp(1.4 - 2.8 * std::abs(t - middle), 0.0, 1.0));
  };
  return {channel(0.1), channel(0.5), channel(0.9)};
}

cv::Mat from_above(const Points& points, const Pose& T, double half_size) {
  cv::Mat image(panel, panel, CV_8UC3, cv::Scalar(24, 20, 16));
  std::vector<float> top(static_cast<std::size_t>(panel) * panel, -1e9F);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& p : points) centre += T * p.cast<double>() / static_cast<double>(points.size());
  for (const auto& point : points) {
    const Eigen::Vector3d p = T * point.cast<double>();
    const int u = static_cast<int>(panel * (0.5 + 0.5 * (p.x() - centre.x()) / half_size));
    const int v = static_cast<int>(panel * (0.5 - 0.5 * (p.y() - centre.y()) / half_size));
    if (u < 0 || v < 0 || u >= panel || v >= panel) continue;
    float& highest = top[static_cast<std::size_t>(v * panel + u)];
    if (p.z() <= static_cast<double>(highest)) continue;
    highest = static_cast<float>(p.z());
    image.at<cv::Vec3b>(v, u) = colour(p.z());
  }
  return image;
}

cv::Mat density_panel(const DensityImage& density) {
  cv::Mat grey(density.height, density.width, CV_8UC1,
               const_cast<std::uint8_t*>(density.pixels.data()));
  cv::Mat flipped, image(panel, panel, CV_8UC3, cv::Scalar(0, 0, 0));
  cv::flip(grey, flipped, 0);
  cv::cvtColor(flipped, flipped, cv::COLOR_GRAY2BGR);
  const double scale = static_cast<double>(panel) / std::max(density.width, density.height);
  cv::resize(flipped, flipped, {}, scale, scale, cv::INTER_AREA);
  const cv::Rect place((panel - flipped.cols) / 2, (panel - flipped.rows) / 2, flipped.cols,
                       flipped.rows);
  flipped.copyTo(image(place));
  return image;
}

/// A scan's points where they were seen from at the scan's stamp.
Points deskewed(const Scan& scan, const Pose& start, const SimulatedRecording* simulation) {
  if (simulation == nullptr || scan.times.empty()) return scan.points;
  Points result;
  const Pose inverse = start.inverse();
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto offset = std::llround(1e9 * static_cast<double>(scan.times[i]));
    const Pose T = inverse * simulation->pose_at(scan.stamp + offset);
    result.push_back((T * scan.points[i].cast<double>()).cast<float>());
  }
  return result;
}

struct Statistics {
  std::size_t maps = 0;
  double points = 0, occupied = 0, mean_density = 0, features = 0;
  std::array<double, 5> histogram{};  ///< share of occupied pixels in fifths of the grey scale
};

void add(Statistics& sum, const LocalMap& map, const DensityImage& image,
         const Features& features) {
  ++sum.maps;
  sum.points += static_cast<double>(map.points.size());
  sum.features += static_cast<double>(features.keypoints.size());
  std::size_t occupied = 0;
  double total = 0;
  std::array<double, 5> histogram{};
  for (const std::uint8_t pixel : image.pixels) {
    if (pixel == 0) continue;
    ++occupied;
    total += pixel;
    histogram[static_cast<std::size_t>(pixel) * 5 / 256] += 1.0;
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, occupied));
  sum.occupied += static_cast<double>(occupied);
  sum.mean_density += total / n;
  for (std::size_t i = 0; i < 5; ++i) sum.histogram[i] += histogram[i] / n;
}

void draw(const std::string& path, const std::string& picture, std::size_t most_maps) {
  std::unique_ptr<Recording> recording = open_any_recording(path);
  const auto* simulation = dynamic_cast<const SimulatedRecording*>(recording.get());
  const Trajectory truth = recording->ground_truth();
  if (truth.size() != recording->size()) throw InputError(path + ": has no pose for each scan");
  LocalMapBuilder builder{LocalMapOptions{}};
  Statistics sum;
  Points scan_shown;
  for (std::size_t i = 0; i < recording->size() && sum.maps < most_maps; ++i) {
    const Points points = deskewed(recording->read(i), truth[i].pose, simulation);
    if (scan_shown.empty()) scan_shown = points;
    const std::optional<LocalMap> map = builder.add(points, truth[i].pose);
    if (!map) continue;
    const GroundAlignment ground = align_to_ground(map->points, GroundAlignmentOptions{});
    const DensityImage image =
        make_density_image(map->points, ground.T_ground_map, DensityImageOptions{});
    add(sum, *map, image, extract_features(image, FeatureOptions{}));
    if (picture.empty() || sum.maps > 1) continue;
    Pose level = ground.T_ground_map;
    level.translation.head<2>().setZero();
    cv::Mat row;
    cv::hconcat(std::vector<cv::Mat>{from_above(scan_shown, level, 40.0),
                                     from_above(map->points, level, 100.0), density_panel(image)},
                row);
    if (!cv::imwrite(picture, row)) throw InputError(picture + ": cannot be written");
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, sum.maps));
  std::printf("| %s | %zu | %.0f | %.0f | %.0f |", path.c_str(), sum.maps, sum.points / n,
              sum.occupied / n, sum.mean_density / n);
  for (const double share : sum.histogram) std::printf(" %.1f", 100.0 * share / n);
  std::printf(" | %.0f |\n", sum.features / n);
}

void thickness(const std::string& path) {
  const auto recording = open_simulation(path);
  for (const bool deskew : {true, false}) {
    const auto result = testing::wall_thickness(*recording, 60, 40, 4, deskew);
    std::printf("%s %s: %.1f mm rms over %zu walls, %zu points\n", path.c_str(),
                deskew ? "deskewed" : "not deskewed", 1e3 * result.rms, result.walls,
                result.points);
  }
}

}  // namespace
}  // namespace groundloop

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw groundloop::InputError("RECORDING [PICTURE.png] [--thickness]");
    const std::string last = argv[argc - 1];
    if (last == "--thickness") {
      groundloop::thickness(argv[1]);
    } else {
      groundloop::draw(argv[1], argc > 2 ? argv[2] : "", argc > 2 ? 1 : 8);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
