#include <array>
#include <cstdio>

#include "apps/report/merge_documents.hpp"
#include "apps/report/report.hpp"

namespace groundloop::apps {
namespace {

std::string fixed(double value, int decimals) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, value);
  return buffer.data();
}

std::string rmse(const std::optional<TrajectoryEvaluation>& e) {
  return e ? fixed(e->ape.translation_m.rmse, 3) : std::string("–");
}

ReportTable session_table(const MergeResult& result, const MergeEvaluation& evaluation) {
  ReportTable table{"Sessions",
                    "APE: rmse of the position after SE(3) alignment, m; by the reference: the "
                    "alignment of the session that names the frame, so that the error between the "
                    "two shows.",
                    {"session", "frame", "scans", "local maps", "APE odometry", "APE optimised",
                     "APE by the reference"},
                    {}};
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    const MergedPart& part = result.parts[p];
    table.rows.push_back({part.source->name, result.parts[part.frame].source->name,
                          std::to_string(part.trajectory.size()), std::to_string(part.maps.size()),
                          rmse(evaluation.odometry[p]), rmse(evaluation.optimised[p]),
                          rmse(evaluation.by_reference[p])});
  }
  return table;
}

ReportTable pair_table(const MergeResult& result) {
  ReportTable table{"Between sessions",
                    "Overlap: share of the later session's local maps that lie on ground of the "
                    "earlier one.",
                    {"reference", "query", "candidates", "verified", "accepted", "overlap"},
                    {}};
  for (const SessionPair& pair : result.pairs) {
    const MergedPart& query = result.parts[pair.query];
    const MergedPart& reference = result.parts[pair.reference];
    const bool one = query.frame == reference.frame;
    table.rows.push_back(
        {reference.source->name, query.source->name, std::to_string(pair.candidates),
         std::to_string(pair.verified), std::to_string(pair.accepted),
         pair.joined_before ? std::string("merged before")
         : one
             ? fixed(static_cast<double>(pair.shared_maps) / static_cast<double>(query.maps.size()),
                     2)
             : std::string("not connected")});
  }
  return table;
}

ReportClosure report_closure(const MergeResult& result, const ClosureRecord& c) {
  ReportClosure row;
  row.reference = c.reference_session + "/" + std::to_string(c.reference_map);
  row.query = c.query_session + "/" + std::to_string(c.query_map);
  row.source = to_string(c.source);
  row.matches = c.matches;
  row.inliers = c.inliers;
  row.status = to_string(c.status);
  row.overlap = c.overlap;
  row.rmse_m = c.rmse;
  for (const MergedPart& part : result.parts) {
    if (part.source->name == c.reference_session)
      row.reference_position = part.maps[c.reference_map].T_world_map.translation;
    if (part.source->name == c.query_session)
      row.query_position = part.maps[c.query_map].T_world_map.translation;
  }
  return row;
}

}  // namespace

std::string merge_report(const MergeResult& result, const MergeEvaluation& evaluation,
                         const std::vector<ManifestLeftOut>& left_out, const Config& config) {
  ReportInput input;
  input.title = "Merged sessions";
  input.facts = {{"groundloop", GROUNDLOOP_VERSION},
                 {"sessions", std::to_string(result.parts.size())}};
  if (evaluation.joint)
    input.facts.emplace_back("joint APE", fixed(evaluation.joint->ape.translation_m.rmse, 3) +
                                              " m rmse, one SE(3) alignment for all sessions");
  for (const std::string& note : result.notes) input.facts.emplace_back("connection", note);
  for (const ManifestLeftOut& l : left_out)
    input.facts.emplace_back("left out", l.input + ": " + l.reason);
  const int first = result.parts.front().frame;
  for (const MergedPart& part : result.parts) {
    if (part.frame == first) {
      input.sessions.push_back({part.source->name, part.trajectory});
    } else {
      input.facts.emplace_back("own frame",
                               "'" + part.source->name + "' is not in the picture: no connection");
    }
  }
  for (const ClosureRecord& c : result.closures) {
    if (c.reference_session != c.query_session) input.closures.push_back(report_closure(result, c));
  }
  input.tables = {session_table(result, evaluation), pair_table(result)};
  input.timing_s = {{"matching", result.times.matching},
                    {"verification", result.times.verification},
                    {"optimisation", result.times.optimisation}};
  input.configuration = to_yaml(config);
  return make_report(input);
}

}  // namespace groundloop::apps
