// Lists of closures as detectors leave them: closures.csv, matches of `groundloop match`, or any
// CSV whose header names its columns:
//
//   reference_map,query_map          maps of the session, or
//   reference_scan,query_scan        scans of it, from 0; counted for the maps they belong to
//   score (or inliers)               more is surer; without it all are equally sure
//   tx,ty,tz,qx,qy,qz,qw             T_query_reference, if there is one
//   reference_session,query_session  where there are several
//
// Other columns are passed over, and lines that begin with # as well.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/commands/evaluated_sessions.hpp"
#include "loopclosure/evaluation/evaluation.hpp"

namespace groundloop::apps {

/// The session's own closures.csv, inliers as scores.
[[nodiscard]] std::vector<ReportedClosure> session_closures(
    const std::vector<EvaluatedPart>& parts);

/// A list of any detector. The older map of a pair is made the reference; of several rows of one
/// pair that with the greatest score stays. Throws InputError naming file, line and what is
/// missing.
[[nodiscard]] std::vector<ReportedClosure> read_closure_list(
    const std::filesystem::path& file, const std::vector<EvaluatedPart>& parts);

}  // namespace groundloop::apps
