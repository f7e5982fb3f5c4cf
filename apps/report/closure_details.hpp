// What the page shows when a closure is opened: the density images of both maps with keypoints and
// matches, as the detector saw them, and the points about the place where the maps meet, to be cut
// and looked at from above before and after registration.
#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/blobs.hpp"
#include "apps/report/closure_table.hpp"
#include "apps/report/session_contents.hpp"

namespace groundloop::apps {

struct ClosureDetailLimits {
  std::size_t closures = 60;     ///< at most so many are shown in detail
  double radius = 25.0;          ///< m about the place where the maps meet
  std::size_t points = 5000;     ///< of each map
  std::size_t bytes = 5U << 20;  ///< of all of them, in base64; the rest goes without
};

/// {maps: {id: {...}}, closures: {place in the table: {...}}}. Accepted closures come first, then
/// those that were registered, then those with most inliers.
[[nodiscard]] nlohmann::ordered_json closure_details(const SessionContents& contents,
                                                     const std::vector<ClosureRow>& rows,
                                                     Blobs& blobs,
                                                     const ClosureDetailLimits& limits = {});

}  // namespace groundloop::apps
