// Two sessions side by side: of one recording by two configurations or versions, of two recordings,
// or one and the merge that holds it.
#pragma once

#include <vector>

#include "apps/report/html_page.hpp"
#include "apps/report/session_contents.hpp"

namespace groundloop::apps {

/// Tables of figures, trajectory, closures and options, with plots of the trajectories where both
/// hold the same recording (by the stamps of their scans). Truths are one a recording and may be
/// empty.
[[nodiscard]] Page compare_sessions(const SessionContents& a,
                                    const std::vector<Trajectory>& truths_a,
                                    const SessionContents& b,
                                    const std::vector<Trajectory>& truths_b);

}  // namespace groundloop::apps
