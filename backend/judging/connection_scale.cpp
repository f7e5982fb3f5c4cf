#include "backend/judging/connection_scale.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "backend/graph/chains.hpp"
#include "backend/graph/graph_chains.hpp"
#include "backend/graph/odometry_tree.hpp"
#include "backend/judging/closure_groups.hpp"
#include "backend/judging/graph_evidence.hpp"
#include "backend/judging/robust.hpp"

namespace groundloop {
namespace {

// Neighbours along both ways may be false together, m: half a local map.
constexpr double kNeighbourDistance = 50.0;
// Standard deviation of the logarithm of a scale before any closure is seen.
constexpr double kLogScale = 1.0;
// Factors of sqrt(2) up to eight times.
constexpr int kScales = 7;
// Two closures agree by chance where odometry is believed little enough.
constexpr std::size_t kFewest = 3;

double scale_of(int step) { return std::exp(0.5 * std::numbers::ln2 * step); }

// Of the closures of a set, which may be empty, true and all others false.
double log_evidence(const FramePair& frames, PoseGraph graph,
                    const std::vector<PairwiseClosure>& between, const std::vector<int>& set,
                    double probability) {
  if (!set.empty()) {
    const Pose T_x_y = alignment_of(graph, between, set);
    for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
      if (frames.in_y[v]) graph.vertices[v].pose = T_x_y * graph.vertices[v].pose;
    }
  }
  const std::size_t own = graph.edges.size();
  for (const PairwiseClosure& c : between) {
    GraphEdge edge{c.from, c.to, c.T_from_to.T_from_to, c.T_from_to.covariance.inverse(),
                   EdgeKind::closure};
    edge.information = (0.5 * (edge.information + edge.information.transpose())).eval();
    edge.rejected = true;
    graph.edges.push_back(edge);
  }
  std::vector<std::size_t> called_true;
  std::vector<std::size_t> called_false;
  for (const int i : set) graph.edges[own + static_cast<std::size_t>(i)].rejected = false;
  for (std::size_t k = own; k < graph.edges.size(); ++k)
    (graph.edges[k].rejected ? called_false : called_true).push_back(k);
  const OdometryTree odometry(graph);
  const auto group = [&](const std::vector<std::size_t>& closures) {
    return group_closures(graph, odometry, closures, kNeighbourDistance,
                          chi_square_quantile_6(probability));
  };
  const CondensedGraph condensed = condense_chains(graph);
  // One closure says where the frames lie to each other, which may be anywhere, as a false one may.
  double sum = log_marginal_density(condensed.graph) + log_prior(group(called_true), true);
  if (!set.empty()) sum -= std::log(kFalseClosureVolume);
  const ClosureGroups false_groups = group(called_false);
  for (const double inner : false_groups.inner_log_density)
    sum += inner - std::log(kFalseClosureVolume);
  return sum + log_prior(false_groups, false);
}

}  // namespace

Pose alignment_of(const PoseGraph& graph, const std::vector<PairwiseClosure>& between,
                  const std::vector<int>& set) {
  std::vector<Eigen::Vector3d> in_y;
  std::vector<Eigen::Vector3d> in_x;
  std::vector<Pose> T_x_y;
  for (const int k : set) {
    const PairwiseClosure& c = between[static_cast<std::size_t>(k)];
    const Pose& P_y = graph.vertices[c.from].pose;
    const Pose P_x = graph.vertices[c.to].pose * c.T_from_to.T_from_to.inverse();
    in_y.push_back(P_y.translation);
    in_x.push_back(P_x.translation);
    T_x_y.push_back(P_x * P_y.inverse());
  }
  std::size_t best = 0;
  double least = -1.0;
  for (std::size_t k = 0; k < set.size(); ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < set.size(); ++i) sum += (T_x_y[k] * in_y[i] - in_x[i]).norm();
    if (least >= 0.0 && sum >= least) continue;
    least = sum;
    best = k;
  }
  return T_x_y[best];
}

void scale_steps(PoseGraph& graph, const std::vector<char>& in_y, bool y, double scale) {
  for (GraphEdge& edge : graph.edges) {
    if (edge.kind == EdgeKind::odometry && (in_y[edge.from] != 0) == y)
      edge.information /= scale * scale;
  }
}

ConnectionTrial connection_at(const FramePair& frames, const std::vector<PairwiseClosure>& between,
                              double scale_x, double scale_y, const ConsistencyOptions& options) {
  PoseGraph graph = frames.graph;
  scale_steps(graph, frames.in_y, false, scale_x);
  scale_steps(graph, frames.in_y, true, scale_y);
  std::vector<int> sources;
  for (const PairwiseClosure& c : between) {
    sources.push_back(c.from);
    sources.push_back(c.to);
  }
  const GraphChains chains(graph, sources);
  const ChainFunction chain = [&](int from, int to) { return chains.between(from, to); };
  ConnectionTrial trial{scale_x, scale_y, consistent_sets(between, chain, chain, options), 0.0};
  const auto squared_log = [](double scale) { return std::log(scale) * std::log(scale); };
  trial.log_evidence =
      log_evidence(frames, std::move(graph), between, trial.found.sets.front(),
                   options.probability) -
      0.5 * (squared_log(scale_x) + squared_log(scale_y)) / (kLogScale * kLogScale);
  return trial;
}

double log_likelihood_ratio(const FramePair& frames, const std::vector<PairwiseClosure>& between,
                            const ConnectionTrial& trial, const ConsistencyOptions& options) {
  return trial.log_evidence - log_evidence(frames, frames.graph, between, {}, options.probability);
}

ConnectionTrial best_connection(const FramePair& frames,
                                const std::vector<PairwiseClosure>& between,
                                const ConsistencyOptions& options) {
  ConnectionTrial best = connection_at(frames, between, 1.0, 1.0, options);
  if (between.size() < kFewest || best.found.sets.size() == 1) return best;
  std::set<std::pair<int, int>> tried{{0, 0}};
  std::pair<int, int> at(0, 0);
  const auto consider = [&](int x, int y) {
    if (std::min(x, y) < 0 || std::max(x, y) >= kScales || !tried.emplace(x, y).second) return;
    ConnectionTrial trial = connection_at(frames, between, scale_of(x), scale_of(y), options);
    if (trial.found.sets.front().size() < kFewest || trial.log_evidence <= best.log_evidence)
      return;
    best = std::move(trial);
    at = {x, y};
  };
  // Either frame, or both; then what one errs less the other may err more.
  for (int i = 1; i < kScales; ++i) {
    consider(i, i);
    consider(i, 0);
    consider(0, i);
  }
  for (std::pair<int, int> centre(-1, -1); centre != at;) {
    centre = at;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) consider(centre.first + x, centre.second + y);
    }
  }
  return best;
}

}  // namespace groundloop
