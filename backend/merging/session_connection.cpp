#include "backend/merging/session_connection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <spdlog/spdlog.h>

#include "backend/graph/graph_chains.hpp"
#include "backend/judging/connection_scale.hpp"

namespace groundloop {
namespace {

// A connection is tested where the solution is known to about this, m: farther off a failure of
// registration would say nothing about the connection.
constexpr double kWellKnown = 1.5;
// Alignments this far apart (m, at the closures; rad) are different claims.
constexpr double kRivalDistance = 10.0;
constexpr double kRivalAngle = 0.17;

// Whether a tested pair confirms a connection, where it is true and where it joins places that
// look alike: of the tested pairs of true connections between simulated sensors, days and ways 17
// of 26 were confirmed; one in twenty verified closures is false (closure_groups.cpp).
constexpr double kConfirmsTrue = 0.5;
constexpr double kConfirmsFalse = 0.05;
// Logarithm of the odds, before pairs are tested, that a set which agrees is no look-alike.
constexpr double kLogOddsOfLookAlike = 3.0;

// Closures that would join frame y to frame x.
struct Proposal {
  int x = 0, y = 0;
  std::vector<int> set;  // positions in JointProblem::closures
  Pose T_x_y;
  int rival = 0;  // closures of the largest set that claims another alignment
  int inliers = 0;
  double scale_x = 1.0, scale_y = 1.0;  // of what the frames' odometries are taken to err
};

struct Ends {
  int in_x, in_y;
  RelativePose T_y_x;  // of the two vertices
};

Ends ends_of(const JointProblem& problem, int closure, int y) {
  const ClosureRecord& c = problem.closures[closure];
  const GraphEdge edge = problem.edge_of(c);
  const RelativePose T_query_reference{edge.T_from_to, covariance_of(edge.information)};
  const int query = problem.query_vertex(c);
  const int reference = problem.reference_vertex(c);
  if (problem.frame_of(query) == y) return {reference, query, T_query_reference};
  return {query, reference, inverse(T_query_reference)};
}

// Whether two alignments differ, as seen from `at` in y.
bool rivals(const Pose& T_x_y, const Pose& other, const Eigen::Vector3d& at) {
  return rotation_angle((T_x_y.inverse() * other).rotation) > kRivalAngle ||
         (other * at - T_x_y * at).norm() > kRivalDistance;
}

// The two frames alone, what is step and what is closure in them told apart.
FramePair pair_of(const JointProblem& problem, int x, int y) {
  FramePair pair{problem.graph, {}};
  std::erase_if(pair.graph.edges, [&](const GraphEdge& edge) {
    const int frame = problem.frame_of(edge.from);
    return frame != x && frame != y;
  });
  for (GraphEdge& edge : pair.graph.edges) {
    if (edge.kind == EdgeKind::settled) edge.kind = EdgeKind::closure;
  }
  for (std::size_t v = 0; v < problem.part_of.size(); ++v)
    pair.in_y.push_back(problem.frame_of(static_cast<int>(v)) == y);
  return pair;
}

// The closures between two frames that are left.
struct Between {
  std::vector<int> closures;  // positions in JointProblem::closures
  std::vector<PairwiseClosure> pairwise;
};

Between closures_between(const JointProblem& problem, int x, int y) {
  Between between;
  for (std::size_t k = 0; k < problem.closures.size(); ++k) {
    const ClosureRecord& c = problem.closures[k];
    if (c.status != ClosureStatus::accepted) continue;
    const int q = problem.frame_of(problem.query_vertex(c));
    const int r = problem.frame_of(problem.reference_vertex(c));
    if (!((q == x && r == y) || (q == y && r == x))) continue;
    between.closures.push_back(static_cast<int>(k));
    const Ends ends = ends_of(problem, static_cast<int>(k), y);
    between.pairwise.push_back({ends.in_y, ends.in_x, ends.T_y_x});
  }
  return between;
}

// The largest consistent set between two frames; empty where no closures are left.
Proposal propose(const JointProblem& problem, int x, int y, const MergeOptions& options) {
  Proposal proposal{x, y, {}, {}};
  const auto [closures, between] = closures_between(problem, x, y);
  if (between.empty()) return proposal;
  const FramePair pair = pair_of(problem, x, y);
  ConnectionTrial best = connection_at(pair, between, 1.0, 1.0, options.consistency);
  // Odometry is doubted only where it would keep the frames apart: to doubt it more than needed
  // leaves the shape of both frames to the closures between them, whose errors are known less well.
  if (options.connection.estimate_scale &&
      static_cast<int>(best.found.sets.front().size()) < options.connection.min_closures)
    best = best_connection(pair, between, options.consistency);
  proposal.scale_x = best.scale_x;
  proposal.scale_y = best.scale_y;
  proposal.T_x_y = alignment_of(pair.graph, between, best.found.sets.front());
  for (const int i : best.found.sets.front()) {
    proposal.set.push_back(closures[i]);
    proposal.inliers += problem.closures[closures[i]].inliers;
  }
  for (const std::vector<int>& set : best.found.sets) {
    const Eigen::Vector3d at =
        pair.graph.vertices[between[static_cast<std::size_t>(set.front())].from].pose.translation;
    if (rivals(proposal.T_x_y, alignment_of(pair.graph, between, set), at))
      proposal.rival = std::max(proposal.rival, static_cast<int>(set.size()));
  }
  return proposal;
}

// Why the closures do not suffice, or empty.
std::string shortcoming(const JointProblem& problem, const Proposal& proposal,
                        const ConnectionOptions& options) {
  const auto size = static_cast<int>(proposal.set.size());
  if (size < options.min_closures) {
    const ClosureRecord& c = problem.closures[proposal.set.front()];
    if (size > 1 || c.inliers < options.single_inliers ||
        c.overlap.value_or(0.0) < options.single_overlap) {
      return "only " + std::to_string(size) + " of their closures agree, fewer than " +
             std::to_string(options.min_closures);
    }
  }
  if (proposal.rival > 1 && proposal.rival > options.rival_share * size) {
    return "another alignment is claimed by " + std::to_string(proposal.rival) +
           " closures against " + std::to_string(size) + ", so the places look alike";
  }
  return {};
}

// Of the proposal's set, over both odometries as they are taken to err.
double log_likelihood_ratio_of(const JointProblem& problem, const Proposal& proposal,
                               const ConsistencyOptions& options) {
  const FramePair pair = pair_of(problem, proposal.x, proposal.y);
  const Between between = closures_between(problem, proposal.x, proposal.y);
  const ConnectionTrial trial =
      connection_at(pair, between.pairwise, proposal.scale_x, proposal.scale_y, options);
  return log_likelihood_ratio(pair, between.pairwise, trial, options);
}

// Pairs of maps outside the set that overlap in the connection, and how many registration confirms.
struct Test {
  std::size_t tried = 0, confirmed = 0;
  std::vector<ClosureRecord> found;

  // Logarithm of the odds against places that look alike.
  [[nodiscard]] double log_odds() const {
    const auto yes = static_cast<double>(confirmed);
    const auto no = static_cast<double>(tried - confirmed);
    return kLogOddsOfLookAlike + yes * std::log(kConfirmsTrue / kConfirmsFalse) +
           no * std::log((1.0 - kConfirmsTrue) / (1.0 - kConfirmsFalse));
  }
};

// What a connection is missing, or nothing.
std::string missing(const Test& test, double log_ratio, const ConnectionOptions& options) {
  const bool borne_out =
      test.confirmed > 0 && static_cast<double>(test.confirmed) >=
                                options.min_confirmed * static_cast<double>(test.tried);
  if (borne_out) return {};
  std::array<char, 160> text{};
  if (log_ratio < options.min_evidence) {
    std::snprintf(text.data(), text.size(),
                  "and that they agree by chance is not unlikely enough: the logarithm of the "
                  "likelihood ratio is %.1f, %.1f is asked",
                  log_ratio, options.min_evidence);
  } else if (test.log_odds() < 0.0) {
    std::snprintf(text.data(), text.size(), "so these are places that look alike");
  }
  return text.data();
}

// Tries pairs of maps that must overlap if the connection is true.
Test test_connection(JointProblem& problem, const PoseGraph& solved, const Proposal& proposal,
                     const ConnectionOptions& options, const Progress& progress) {
  std::vector<std::pair<int, int>> known;
  for (const int k : proposal.set) {
    const Ends ends = ends_of(problem, k, proposal.y);
    known.emplace_back(ends.in_x, ends.in_y);
  }
  std::vector<int> in_x;
  std::vector<int> in_y;
  for (std::size_t v = 0; v < problem.part_of.size(); ++v) {
    const int frame = problem.frame_of(static_cast<int>(v));
    if (frame == proposal.x) in_x.push_back(static_cast<int>(v));
    if (frame == proposal.y) in_y.push_back(static_cast<int>(v));
  }
  const GraphChains chains(solved, in_y);
  std::vector<std::pair<int, int>> pairs;
  for (const int b : in_y) {
    for (const int a : in_x) {
      if (std::find(known.begin(), known.end(), std::make_pair(a, b)) != known.end()) continue;
      if (chains.between(b, a).covariance.topLeftCorner<3, 3>().trace() > kWellKnown * kWellKnown)
        continue;
      if (problem.predicted_overlap(solved, a, b) >= options.min_predicted_overlap)
        pairs.emplace_back(a, b);
    }
  }
  Test test;
  const std::size_t trials =
      std::min(pairs.size(), static_cast<std::size_t>(std::max(options.max_trials, 0)));
  for (std::size_t i = 0; i < trials; ++i) {
    if (progress) progress("testing connections", i, trials);
    const auto [a, b] = pairs[i * pairs.size() / trials];
    ++test.tried;
    if (std::optional<ClosureRecord> record = problem.try_pair(solved, a, b)) {
      ++test.confirmed;
      test.found.push_back(std::move(*record));
    }
  }
  return test;
}

// The frame that stays where it is: that of a fixed recording, else the one named first.
bool must_stay(const JointProblem& problem, int frame) {
  return std::any_of(problem.parts.begin(), problem.parts.end(),
                     [&](const MergedPart& p) { return p.frame == frame && p.fixed; });
}

void refuse(JointProblem& problem, const Proposal& proposal, const std::string& why) {
  problem.notes.push_back(problem.frame_name(proposal.y) + " not connected to " +
                          problem.frame_name(proposal.x) + ": " + why);
  spdlog::info("{}", problem.notes.back());
  for (const int k : proposal.set) problem.closures[k].status = ClosureStatus::inconsistent;
}

// What the connection holds of the frames' odometries, or nothing where they are as stated.
std::string scales_in_words(const JointProblem& problem, const Proposal& proposal) {
  std::string text;
  for (const auto& [frame, scale] :
       {std::pair(proposal.x, proposal.scale_x), std::pair(proposal.y, proposal.scale_y)}) {
    if (scale == 1.0) continue;
    std::array<char, 32> factor{};
    std::snprintf(factor.data(), factor.size(), "%.1f", scale);
    text += "; the odometry of " + problem.frame_name(frame) + " errs " + factor.data() +
            " times as much as it says";
  }
  return text;
}

// Brings frame y to x, solves both together and keeps that if it passes the test.
void try_connection(JointProblem& problem, const Proposal& proposal, const MergeOptions& options,
                    const Progress& progress) {
  PoseGraph trial = problem.graph;
  const bool x_moves = must_stay(problem, proposal.y);
  const Pose move = x_moves ? proposal.T_x_y.inverse() : proposal.T_x_y;
  const int moving = x_moves ? proposal.x : proposal.y;
  const int staying = x_moves ? proposal.y : proposal.x;
  for (std::size_t v = 0; v < trial.vertices.size(); ++v) {
    if (problem.frame_of(static_cast<int>(v)) == moving)
      trial.vertices[v].pose = move * trial.vertices[v].pose;
  }
  for (GraphEdge& edge : trial.edges) {
    const int frame = problem.frame_of(edge.from);
    if (edge.kind != EdgeKind::odometry || (frame != proposal.x && frame != proposal.y)) continue;
    const double scale = frame == proposal.x ? proposal.scale_x : proposal.scale_y;
    edge.information /= scale * scale;
  }
  for (const int k : proposal.set) trial.edges.push_back(problem.edge_of(problem.closures[k]));
  // Only `staying` has a gauge of its own; the other is joined to it by the closures.
  std::vector<int> frames;
  for (MergedPart& part : problem.parts) {
    frames.push_back(part.frame);
    if (part.frame == moving) part.frame = staying;
  }
  problem.solve(trial, {staying}, false, progress);
  for (std::size_t p = 0; p < frames.size(); ++p) problem.parts[p].frame = frames[p];
  Test test = test_connection(problem, trial, proposal, options.connection, progress);
  const std::string tested = std::to_string(test.confirmed) + " of " + std::to_string(test.tried) +
                             " further pairs of maps that overlap in it confirm it";
  const double log_ratio = log_likelihood_ratio_of(problem, proposal, options.consistency);
  const std::string lacks = missing(test, log_ratio, options.connection);
  if (!lacks.empty()) {
    refuse(
        problem, proposal,
        std::to_string(proposal.set.size()) + " closures agree, but only " + tested + ", " + lacks);
    return;
  }
  std::array<char, 64> evidence{};
  std::snprintf(evidence.data(), evidence.size(), " (log likelihood ratio %.1f)", log_ratio);
  problem.notes.push_back(problem.frame_name(moving) + " connected to " +
                          problem.frame_name(staying) + " by " +
                          std::to_string(proposal.set.size()) + " closures that agree" +
                          evidence.data() + "; " + tested + scales_in_words(problem, proposal));
  spdlog::info("{}", problem.notes.back());
  for (MergedPart& part : problem.parts) {
    if (part.frame == proposal.x) part.odometry_scale *= proposal.scale_x;
    if (part.frame == proposal.y) part.odometry_scale *= proposal.scale_y;
    if (part.frame == moving) part.frame = staying;
  }
  for (ClosureRecord& record : test.found) {
    if (problem.knows(record)) continue;
    trial.edges.push_back(problem.edge_of(record));
    problem.closures.push_back(std::move(record));
  }
  problem.graph = std::move(trial);
}

}  // namespace

void connect_sessions(JointProblem& problem, const MergeOptions& options,
                      const Progress& progress) {
  const auto n = static_cast<int>(problem.parts.size());
  while (true) {
    Proposal best;
    std::vector<Proposal> poor;
    for (int x = 0; x < n; ++x) {
      if (problem.parts[x].frame != x) continue;
      for (int y = x + 1; y < n; ++y) {
        if (problem.parts[y].frame != y) continue;
        if (must_stay(problem, x) && must_stay(problem, y)) continue;
        Proposal proposal = propose(problem, x, y, options);
        if (proposal.set.empty()) continue;
        if (!shortcoming(problem, proposal, options.connection).empty()) {
          poor.push_back(std::move(proposal));
        } else if (proposal.set.size() > best.set.size() ||
                   (proposal.set.size() == best.set.size() && proposal.inliers > best.inliers)) {
          best = std::move(proposal);
        }
      }
    }
    if (!best.set.empty()) {
      try_connection(problem, best, options, progress);
      continue;
    }
    // Nothing more connects: what is left is contradicted or too little.
    for (const Proposal& proposal : poor)
      refuse(problem, proposal, shortcoming(problem, proposal, options.connection));
    for (ClosureRecord& c : problem.closures) {
      if (c.status == ClosureStatus::accepted && problem.frame_of(problem.query_vertex(c)) !=
                                                     problem.frame_of(problem.reference_vertex(c)))
        c.status = ClosureStatus::inconsistent;
    }
    return;
  }
}

}  // namespace groundloop
