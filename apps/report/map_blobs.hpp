// The 3-D view's cloud as arrays of the page: places in whole centimetres from the corner of a
// node, as differences along the Morton curve, and beside them the row of each point and how thick
// its surface is.
#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "apps/report/blobs.hpp"
#include "apps/report/map_view.hpp"

namespace groundloop::apps {

/// {count, spacing, levels, nodes: blob, chunks: [{nodes, points, place, row, thickness}]}, coarse
/// chunks first. `nodes` holds level, edge, corner x y z, unit (m) and points of each node.
[[nodiscard]] nlohmann::ordered_json map_blobs(const FrameView& view, Blobs& blobs);

}  // namespace groundloop::apps
