#include "backend/merging/joint_problem.hpp"

#include <algorithm>
#include <cmath>

#include "backend/mapping/closure_anchor.hpp"
#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

// Recordings of one session that its closures join share a frame, named by the first of them.
void set_frames(const StoredSession& session, int first_part, std::vector<MergedPart>& parts) {
  const std::vector<int> component = connected_components(session.graph);
  const auto n = static_cast<int>(session.parts.size());
  for (int p = 0; p < n; ++p) {
    int q = 0;
    while (component[session.parts[q].first_map] != component[session.parts[p].first_map]) ++q;
    parts[first_part + p].frame = first_part + q;
  }
}

}  // namespace

JointProblem::JointProblem(const std::vector<StoredSession>& sessions,
                           std::optional<std::size_t> fixed, const MergeOptions& options)
    : options_(options) {
  int maps = 0;
  std::size_t scans = 0, scan_files = 0;
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    const StoredSession& session = sessions[s];
    stores_.push_back(std::make_unique<MapStore>(session.folder, options.matching.registration));
    const auto first_part = static_cast<int>(parts.size());
    const int first_vertex = maps;
    for (const SessionPart& source : session.parts) {
      MergedPart part{&source,    s,          maps, scans,           scan_files,
                      0,          fixed == s, 1.0,  source.odometry, source.trajectory,
                      source.maps};
      for (const LocalMapRecord& map : part.maps) {
        graph.vertices.push_back({maps++, map.T_world_map, false});
        part_of.push_back(static_cast<int>(parts.size()));
      }
      scans += part.trajectory.size();
      scan_files += source.scan_files;
      parts.push_back(std::move(part));
    }
    set_frames(session, first_part, parts);
    for (GraphEdge edge : session.graph.edges) {
      edge.from += first_vertex;
      edge.to += first_vertex;
      if (edge.kind == EdgeKind::closure) edge.kind = EdgeKind::settled;
      graph.edges.push_back(edge);
    }
  }
  footprints_.resize(graph.vertices.size());
}

int JointProblem::query_vertex(const ClosureRecord& closure) const {
  for (const MergedPart& part : parts) {
    if (part.source->name == closure.query_session) return part.first_map + closure.query_map;
  }
  throw std::logic_error("a closure names a recording of the merge");
}

int JointProblem::reference_vertex(const ClosureRecord& closure) const {
  for (const MergedPart& part : parts) {
    if (part.source->name == closure.reference_session)
      return part.first_map + closure.reference_map;
  }
  throw std::logic_error("a closure names a recording of the merge");
}

std::string JointProblem::frame_name(int frame) const {
  std::string name = "'" + parts[frame].source->name + "'";
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].frame == frame && static_cast<int>(p) != frame)
      name += " with '" + parts[p].source->name + "'";
  }
  return name;
}

std::shared_ptr<StoredMap> JointProblem::map(int vertex) {
  const int part = part_of[vertex];
  return store(part).get(vertex - parts[part].first_map + parts[part].source->first_map);
}

const GroundFootprint& JointProblem::footprint(int vertex) {
  if (!footprints_[vertex]) footprints_[vertex] = ground_footprint(map(vertex)->points());
  return *footprints_[vertex];
}

GraphEdge JointProblem::edge_of(const ClosureRecord& c) const {
  const MergedPart& reference = parts[part_of[reference_vertex(c)]];
  const MergedPart& query = parts[part_of[query_vertex(c)]];
  const LocalMapRecord& r = reference.maps[c.reference_map];
  const LocalMapRecord& q = query.maps[c.query_map];
  const ClosureAnchor anchor =
      anchor_closure(c.T_query_reference, r, reference.odometry, q, query.odometry);
  const Trajectory& r_solved = reference.source->trajectory;
  const Trajectory& q_solved = query.source->trajectory;
  return {query_vertex(c), reference_vertex(c),
          carried_to_origins(anchor, r, r_solved, q, q_solved),
          information_between_origins(anchor, c.information, r, r_solved, q, q_solved,
                                      options_.odometry_information),
          EdgeKind::closure};
}

double JointProblem::predicted_overlap(const PoseGraph& poses, int reference, int query) {
  const GroundFootprint& r = footprint(reference);
  const GroundFootprint& q = footprint(query);
  const Pose T_query_reference =
      poses.vertices[query].pose.inverse() * poses.vertices[reference].pose;
  if (T_query_reference.translation.norm() > static_cast<double>(r.radius + q.radius)) return 0.0;
  return footprint_overlap(r, q, T_query_reference);
}

std::optional<ClosureRecord> JointProblem::try_pair(const PoseGraph& poses, int a, int b) {
  const int reference = std::min(a, b);
  const int query = std::max(a, b);
  const Pose T_query_reference =
      poses.vertices[query].pose.inverse() * poses.vertices[reference].pose;
  const std::shared_ptr<StoredMap> q = map(query);
  const std::shared_ptr<StoredMap> r = map(reference);
  VerificationOptions limits = options_.matching.verification;
  limits.min_agreement = options_.revisits.min_agreement;
  limits.between_sessions = true;
  const ClosureVerification result =
      verify_closure(q->target(), q->points(), r->points(), T_query_reference, limits,
                     options_.matching.registration);
  const Pose moved = T_query_reference.inverse() * result.T_query_reference;
  if (result.status != ClosureStatus::accepted ||
      moved.translation.norm() > options_.revisits.max_distance ||
      rotation_angle(moved.rotation) > options_.revisits.max_angle_deg * M_PI / 180.0) {
    return std::nullopt;
  }
  ClosureRecord record;
  record.reference_session = parts[part_of[reference]].source->name;
  record.reference_map = reference - parts[part_of[reference]].first_map;
  record.query_session = parts[part_of[query]].source->name;
  record.query_map = query - parts[part_of[query]].first_map;
  record.source = ClosureSource::overlap;
  record.status = ClosureStatus::accepted;
  record.overlap = result.overlap;
  record.rmse = result.rmse;
  record.T_query_reference = result.T_query_reference;
  record.initial_T_query_reference = T_query_reference;
  record.information = result.information;
  return record;
}

bool JointProblem::knows(const ClosureRecord& closure) const {
  constexpr double kSame = 0.3, kSameTurn = 0.3 * M_PI / 180.0;
  return std::any_of(closures.begin(), closures.end(), [&](const ClosureRecord& c) {
    if (c.status != ClosureStatus::accepted && c.status != ClosureStatus::outlier) return false;
    if (c.query_session != closure.query_session || c.query_map != closure.query_map ||
        c.reference_session != closure.reference_session ||
        c.reference_map != closure.reference_map)
      return false;
    const Pose between = c.T_query_reference.inverse() * closure.T_query_reference;
    return between.translation.norm() < kSame && rotation_angle(between.rotation) < kSameTurn;
  });
}

OptimizationSummary JointProblem::solve(PoseGraph& problem, const std::vector<int>& active,
                                        bool robust, const Progress& progress) {
  std::vector<char> anchored(parts.size(), 0);
  for (const MergedPart& part : parts) {
    if (part.fixed) anchored[part.frame] = 1;
  }
  for (std::size_t v = 0; v < problem.vertices.size(); ++v) {
    const MergedPart& part = parts[part_of[v]];
    const bool idle = std::find(active.begin(), active.end(), part.frame) == active.end();
    const bool first = static_cast<int>(v) == parts[part.frame].first_map;
    problem.vertices[v].fixed = idle || part.fixed || (first && !anchored[part.frame]);
  }
  OptimizerOptions optimizer = options_.optimizer;
  optimizer.robust = robust;
  optimizer.initialisation = "guess";
  return optimize(problem, optimizer, progress);
}

}  // namespace groundloop
