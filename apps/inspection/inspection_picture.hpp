// An inspected recording on one picture: a scan from above and as a range image, the times of its
// points, and the intervals of the scans.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/inspection/inspection.hpp"

namespace groundloop::apps {

/// As PNG. `intervals`: seconds from each scan to the next.
[[nodiscard]] std::vector<std::byte> draw_inspection(const Inspection& inspection,
                                                     const std::vector<double>& intervals);

}  // namespace groundloop::apps
