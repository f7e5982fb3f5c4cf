#include "backend/merging/session_merge.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <spdlog/spdlog.h>

#include "backend/merging/frame_check.hpp"
#include "backend/merging/joint_problem.hpp"
#include "backend/merging/session_connection.hpp"
#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A query map that has this many closures with a recording needs no more.
constexpr int kClosuresOfAMap = 2;
constexpr double kSharedGround = 0.3;

void check_names(const std::vector<StoredSession>& sessions) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const StoredSession& session : sessions) {
    for (const SessionPart& part : session.parts)
      names.emplace_back(part.name, session.folder.path().string());
  }
  std::sort(names.begin(), names.end());
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (names[i].first == names[i - 1].first) {
      throw InputError("two recordings are called '" + names[i].first + "', in " +
                       names[i - 1].second + " and " + names[i].second +
                       "; rename one of the folders");
    }
  }
}

// The matches of a pair from a file, turned so that the recording named first is the reference.
const PairMatches* find_matches(const std::vector<PairMatches>& all, const SessionPart& reference,
                                const SessionPart& query) {
  for (const PairMatches& m : all) {
    if ((m.reference == reference.name && m.query == query.name) ||
        (m.reference == query.name && m.query == reference.name))
      return &m;
  }
  return nullptr;
}

PairMatches turned(const PairMatches& m) {
  PairMatches result{m.query, m.reference, m.query_fingerprint, m.reference_fingerprint, {}};
  for (ClosureRecord c : m.closures) {
    std::swap(c.reference_session, c.query_session);
    std::swap(c.reference_map, c.query_map);
    const RelativePose turn = inverse({c.T_query_reference, Matrix6d::Zero()});
    // Information travels as covariance does, with the inverse adjoint.
    const Matrix6d carry = adjoint(c.T_query_reference.inverse());
    c.information = (carry.transpose() * c.information * carry).eval();
    c.T_query_reference = turn.T_from_to;
    c.initial_T_query_reference = c.initial_T_query_reference.inverse();
    result.closures.push_back(std::move(c));
  }
  return result;
}

void match_pair(JointProblem& problem, const std::vector<PairMatches>& given, SessionPair& pair,
                const MergeOptions& options, MergeTimes& times, const Progress& progress) {
  const SessionPart& reference = *problem.parts[pair.reference].source;
  const SessionPart& query = *problem.parts[pair.query].source;
  PairMatches matches;
  if (const PairMatches* found = find_matches(given, reference, query)) {
    matches = found->reference == reference.name ? *found : turned(*found);
    pair.from_file = matches.reference_fingerprint == reference.fingerprint &&
                     matches.query_fingerprint == query.fingerprint;
    if (!pair.from_file) {
      problem.notes.push_back("the matches of '" + reference.name + "' and '" + query.name +
                              "' are of other sessions of these names; the pair is matched anew");
      spdlog::warn("{}", problem.notes.back());
    }
  }
  if (!pair.from_file) {
    const auto start = Clock::now();
    LoopClosureTimes loop_times;
    matches = match_parts(reference, problem.store(pair.reference), query,
                          problem.store(pair.query), options.matching, &loop_times, progress);
    const double matching = loop_times.matching + loop_times.consensus;
    times.matching += matching;
    times.verification += seconds_since(start) - matching;
    if (options.on_matched) options.on_matched(matches);
  }
  for (ClosureRecord& c : matches.closures) {
    ++pair.candidates;
    pair.verified += c.status == ClosureStatus::accepted ? 1 : 0;
    problem.closures.push_back(std::move(c));
  }
}

std::vector<int> joined_frames(const JointProblem& problem, const std::vector<int>& frames_before) {
  std::vector<int> joined;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    const int frame = problem.parts[p].frame;
    if (frame != frames_before[p] && std::find(joined.begin(), joined.end(), frame) == joined.end())
      joined.push_back(frame);
  }
  std::sort(joined.begin(), joined.end());
  return joined;
}

// The sessions' own edges and the closures between sessions, judged together.
OptimizationSummary judge(JointProblem& problem, std::size_t own_edges,
                          const std::vector<int>& joined, const Progress& progress) {
  problem.graph.edges.resize(own_edges);
  std::vector<ClosureRecord*> judged;
  for (ClosureRecord& c : problem.closures) {
    if (c.status != ClosureStatus::accepted && c.status != ClosureStatus::outlier) continue;
    problem.graph.edges.push_back(problem.edge_of(c));
    judged.push_back(&c);
  }
  OptimizationSummary summary = problem.solve(problem.graph, joined, true, progress);
  for (std::size_t k = 0; k < judged.size(); ++k) {
    const GraphEdge& edge = problem.graph.edges[own_edges + k];
    judged[k]->weight = edge.weight;
    judged[k]->status = edge.rejected ? ClosureStatus::outlier : ClosureStatus::accepted;
  }
  return summary;
}

// Tries pairs of maps of newly connected recordings that overlap in the solution.
std::size_t add_revisits(JointProblem& problem, const std::vector<int>& frames_before,
                         std::vector<std::pair<int, int>>& tried, const MergeOptions& options,
                         const Progress& progress) {
  const auto n = static_cast<int>(problem.graph.vertices.size());
  std::size_t added = 0;
  for (int query = 0; query < n; ++query) {
    if (progress) progress("overlaps between sessions", query, n);
    const int q = problem.part_of[query];
    std::vector<int> closures(problem.parts.size(), 0);
    std::vector<int> closed;
    for (const ClosureRecord& c : problem.closures) {
      if (c.status != ClosureStatus::accepted || problem.query_vertex(c) != query) continue;
      closed.push_back(problem.reference_vertex(c));
      ++closures[problem.part_of[closed.back()]];
    }
    std::vector<std::pair<double, int>> overlapping;
    for (int reference = 0; reference < problem.parts[q].first_map; ++reference) {
      const int r = problem.part_of[reference];
      if (frames_before[q] == frames_before[r] || problem.parts[q].frame != problem.parts[r].frame)
        continue;
      if (closures[r] >= kClosuresOfAMap ||
          std::find(closed.begin(), closed.end(), reference) != closed.end())
        continue;
      if (std::find(tried.begin(), tried.end(), std::make_pair(reference, query)) != tried.end())
        continue;
      const double overlap = problem.predicted_overlap(problem.graph, reference, query);
      if (overlap >= options.revisits.min_predicted_overlap)
        overlapping.emplace_back(-overlap, reference);
    }
    std::sort(overlapping.begin(), overlapping.end());
    for (const auto& [overlap, reference] : overlapping) {
      const int r = problem.part_of[reference];
      if (closures[r] >= kClosuresOfAMap) continue;
      tried.emplace_back(reference, query);
      std::optional<ClosureRecord> record = problem.try_pair(problem.graph, reference, query);
      if (!record || problem.knows(*record)) continue;
      problem.closures.push_back(std::move(*record));
      ++closures[r];
      ++added;
    }
  }
  return added;
}

// Whether a recording's maps lie elsewhere than before.
bool moved(const MergedPart& part, const PoseGraph& graph, const PoseGraph& before) {
  for (std::size_t m = 0; m < part.maps.size(); ++m) {
    const std::size_t v = static_cast<std::size_t>(part.first_map) + m;
    const Pose& now = graph.vertices[v].pose;
    const Pose& then = before.vertices[v].pose;
    if (now.translation != then.translation || now.rotation.coeffs() != then.rotation.coeffs())
      return true;
  }
  return false;
}

// Bends a recording's trajectory to its maps' new poses: the correction at a map's first scan goes
// over into that at the next map's.
void spread(const PoseGraph& graph, MergedPart& part) {
  const std::vector<LocalMapRecord> before = part.maps;
  const auto correction = [&](std::size_t m) {
    return graph.vertices[static_cast<std::size_t>(part.first_map) + m].pose *
           before[m].T_world_map.inverse();
  };
  for (std::size_t m = 0; m < before.size(); ++m) {
    const Pose here = correction(m);
    const Pose next = m + 1 == before.size() ? here : correction(m + 1);
    const auto scans = static_cast<double>(before[m].last_scan + 1 - before[m].first_scan);
    for (std::size_t i = before[m].first_scan; i <= before[m].last_scan; ++i) {
      const double s = static_cast<double>(i - before[m].first_scan) / scans;
      Pose& pose = part.trajectory[i].pose;
      pose = interpolate(here * pose, next * pose, s);
    }
    part.maps[m].T_world_map = part.trajectory[before[m].first_scan].pose;
  }
}

void count(JointProblem& problem, SessionPair& pair) {
  const MergedPart& reference = problem.parts[pair.reference];
  const MergedPart& query = problem.parts[pair.query];
  for (const ClosureRecord& c : problem.closures) {
    pair.accepted += c.status == ClosureStatus::accepted &&
                             c.reference_session == reference.source->name &&
                             c.query_session == query.source->name
                         ? 1
                         : 0;
  }
  if (reference.frame != query.frame || pair.joined_before) return;
  for (std::size_t b = 0; b < query.maps.size(); ++b) {
    for (std::size_t a = 0; a < reference.maps.size(); ++a) {
      if (problem.predicted_overlap(problem.graph, reference.first_map + static_cast<int>(a),
                                    query.first_map + static_cast<int>(b)) < kSharedGround)
        continue;
      ++pair.shared_maps;
      break;
    }
  }
}

// Gauges for the file: fixed recordings, else the first map of each frame.
void mark_gauge(JointProblem& problem) {
  std::vector<char> anchored(problem.parts.size(), 0);
  for (const MergedPart& part : problem.parts) {
    if (part.fixed) anchored[part.frame] = 1;
  }
  for (std::size_t v = 0; v < problem.graph.vertices.size(); ++v) {
    const MergedPart& part = problem.parts[problem.part_of[v]];
    problem.graph.vertices[v].fixed =
        part.fixed ||
        (!anchored[part.frame] && static_cast<int>(v) == problem.parts[part.frame].first_map);
  }
}

// The sessions' own closures and those between them, for the table of the whole; in this order
// their edges stand in the graph.
std::vector<ClosureRecord> all_closures(const std::vector<StoredSession>& sessions,
                                        const JointProblem& problem) {
  std::vector<ClosureRecord> all;
  for (const StoredSession& session : sessions)
    all.insert(all.end(), session.closures.begin(), session.closures.end());
  all.insert(all.end(), problem.closures.begin(), problem.closures.end());
  return all;
}

}  // namespace

MergeResult merge_sessions(const std::vector<StoredSession>& sessions,
                           const std::vector<PairMatches>& matches,
                           std::optional<std::size_t> fixed, const MergeOptions& options,
                           const Progress& progress) {
  check_names(sessions);
  JointProblem problem(sessions, fixed, options);
  const std::size_t own_edges = problem.graph.edges.size();
  const PoseGraph before = problem.graph;
  std::vector<int> frames_before;
  for (const MergedPart& part : problem.parts) frames_before.push_back(part.frame);

  MergeResult result;
  const auto n = static_cast<int>(problem.parts.size());
  for (int query = 1; query < n; ++query) {
    for (int reference = 0; reference < query; ++reference) {
      SessionPair pair{reference, query};
      pair.joined_before = frames_before[reference] == frames_before[query];
      if (!pair.joined_before) match_pair(problem, matches, pair, options, result.times, progress);
      result.pairs.push_back(pair);
    }
  }

  auto start = Clock::now();
  connect_sessions(problem, options, progress);
  const std::vector<int> joined = joined_frames(problem, frames_before);
  if (!joined.empty()) {
    result.summary = judge(problem, own_edges, joined, progress);
    std::vector<std::pair<int, int>> tried;
    for (int round = 0; options.revisits.enabled && round < options.revisits.max_rounds; ++round) {
      if (add_revisits(problem, frames_before, tried, options, progress) == 0) break;
      result.summary = judge(problem, own_edges, joined, progress);
    }
    check_frames(problem, frames_before, before);
  }
  result.times.optimisation = seconds_since(start);

  for (MergedPart& part : problem.parts) {
    if (moved(part, problem.graph, before)) spread(problem.graph, part);
  }
  for (SessionPair& pair : result.pairs) count(problem, pair);
  mark_gauge(problem);
  result.closures = all_closures(sessions, problem);
  result.parts = std::move(problem.parts);
  result.graph = std::move(problem.graph);
  result.notes = std::move(problem.notes);
  return result;
}

}  // namespace groundloop
