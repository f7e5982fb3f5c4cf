// From a local map to what the loop database keeps of it: ground alignment, density image,
// features. The one place where these stages are put together.
#pragma once

#include "frontend/core/scan.hpp"
#include "loopclosure/loop_closure.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

/// Describes `map_points` (m, in the map's frame). A map without points or features has a
/// description without keypoints. Adds the seconds of each stage to `times` where it is given.
[[nodiscard]] MapDescription describe_map(const MapKey& key, const Points& map_points,
                                          const LoopClosureOptions& options,
                                          LoopClosureTimes* times = nullptr);

}  // namespace groundloop
