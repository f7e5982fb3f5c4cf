#include "loopclosure/describe.hpp"

#include <utility>

#include "loopclosure/density_image.hpp"
#include "loopclosure/features.hpp"
#include "loopclosure/ground_alignment.hpp"
#include "loopclosure/stopwatch.hpp"

namespace groundloop {

MapDescription describe_map(const MapKey& key, const Points& map_points,
                            const LoopClosureOptions& options, LoopClosureTimes* times) {
  LoopClosureTimes spent;
  Stopwatch watch;
  MapDescription result;
  result.key = key;
  if (options.ground_alignment.enabled) {
    const GroundAlignment ground = align_to_ground(map_points, options.ground_alignment);
    result.T_ground_map = ground.T_ground_map;
    result.ground_quality = ground.quality;
  }
  spent.ground_alignment = watch.lap();
  const DensityImage image =
      make_density_image(map_points, result.T_ground_map, options.density_image);
  spent.density_image = watch.lap();
  Features features = extract_features(image, options.features);
  result.keypoints = std::move(features.keypoints);
  result.orientations = std::move(features.orientations);
  result.descriptors = std::move(features.descriptors);
  spent.features = watch.lap();
  if (times != nullptr) {
    times->ground_alignment += spent.ground_alignment;
    times->density_image += spent.density_image;
    times->features += spent.features;
  }
  return result;
}

}  // namespace groundloop
