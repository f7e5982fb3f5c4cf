// Pictures of loop closures for the report: the density images of both local maps in one frame, as
// the detector sees them, side by side and one over the other. Where the closure is true, structure
// coincides.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "apps/report/report.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/scan.hpp"
#include "loopclosure/options.hpp"

namespace groundloop::apps {

struct ClosurePictureLimits {
  std::size_t closures = 8;     ///< at most as many, spread evenly over those accepted
  double extent = 200.0;        ///< m along x and y that a picture shows at most
  std::size_t bytes = 1 << 20;  ///< of all pictures; what goes beyond is left out
};

/// Pictures of the accepted ones of `closures`, all in the ground frame of the reference map: the
/// reference, the query brought there by T_query_reference, and both (orange the reference, blue
/// the query, dark where they agree). One pixel of a picture is one of the density image. `points`
/// gives the points of a local map in its own frame; a closure with a map that has none is left
/// out.
[[nodiscard]] std::vector<ReportImage> closure_pictures(
    const std::vector<ClosureRecord>& closures, const std::function<Points(int map)>& points,
    const LoopClosureOptions& options, const ClosurePictureLimits& limits = {});

}  // namespace groundloop::apps
