// report.html of a session, made of nothing but the files in its folder and the ground truth, so
// that `run`, `merge` and `report` make the same page of the same session.
#pragma once

#include <string>
#include <vector>

#include "apps/report/session_contents.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::apps {

/// The page. `truths` are one a recording, poses of its sensor in a world of their own, and may be
/// empty. Throws InputError naming the file where a local map cannot be read.
[[nodiscard]] std::string make_session_report(const SessionContents& contents,
                                              const std::vector<Trajectory>& truths);

}  // namespace groundloop::apps
