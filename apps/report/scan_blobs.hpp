// The scans of a session as arrays of the page: poses by odometry, in the solution and by the
// ground truth, errors, how odometry went, and how certain the solution is.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/report/blobs.hpp"
#include "apps/report/scan_table.hpp"
#include "apps/report/session_contents.hpp"

namespace groundloop::apps {

/// {rows, stamp0, stamp, optimised, odometry, truth?, ...}: one element (or seven, or three) a row
/// of `table`; poses are tx ty tz qx qy qz qw. What the session lacks is not there; what a row
/// lacks is NaN.
[[nodiscard]] nlohmann::ordered_json scan_blobs(const SessionContents& contents,
                                                const ScanTable& table, Blobs& blobs);

}  // namespace groundloop::apps
