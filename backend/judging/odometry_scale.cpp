#include "backend/judging/odometry_scale.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include "backend/graph/chains.hpp"
#include "backend/graph/odometry_tree.hpp"
#include "backend/graph/single_threaded_algebra.hpp"
#include "backend/judging/closure_groups.hpp"
#include "backend/judging/graph_evidence.hpp"
#include "backend/judging/pairwise_consistency.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// Closures this near along both ways may be false together, m: half a local map. Farther apart a
// chain of true ones would count as one event.
constexpr double kNeighbourDistance = 50.0;
// Before any closure is seen: standard deviation of the logarithm of the scale, upward and
// downward. Odometry can be far worse than stated where scenes are poor; that it is better takes
// more than one closure that happens to agree, since trust is what true closures of another session
// are judged by.
constexpr double kLogScaleUpward = 1.0;
constexpr double kLogScaleDownward = 0.35;
// Factors of sqrt(2) from a half to sixteen times.
constexpr double kSmallest = 0.5;
constexpr std::size_t kScales = 11;
constexpr std::size_t kStated = 2;  // place of scale 1 among them

// Weighs verdicts on one graph with its odometry at one scale.
class Evidence {
 public:
  Evidence(const PoseGraph& graph, const RobustOptions& options)
      : graph_(graph),
        odometry_(graph),
        bound_(chi_square_quantile_6(options.inlier_probability)) {}

  // Of the closures' measurements, given which are true.
  [[nodiscard]] double of(PoseGraph solved) const {
    std::vector<std::size_t> accepted;
    std::vector<std::size_t> rejected;
    double sum = 0.0;
    for (std::size_t k = 0; k < solved.edges.size(); ++k) {
      GraphEdge& edge = solved.edges[k];
      if (edge.kind != EdgeKind::closure) continue;
      (edge.rejected ? rejected : accepted).push_back(k);
      edge.weight = 1.0;
    }
    if (!accepted.empty()) {
      sum += log_marginal_density(std::move(solved)) + log_prior(group(accepted), true);
    }
    const ClosureGroups false_groups = group(rejected);
    for (const double inner : false_groups.inner_log_density)
      sum += inner - std::log(kFalseClosureVolume);
    return sum + log_prior(false_groups, false);
  }

 private:
  [[nodiscard]] ClosureGroups group(const std::vector<std::size_t>& closures) const {
    return group_closures(graph_, odometry_, closures, kNeighbourDistance, bound_);
  }

  const PoseGraph& graph_;
  OdometryTree odometry_;
  double bound_;
};

bool is_one_chain(const PoseGraph& graph) {
  PoseGraph odometry = graph;
  for (GraphEdge& edge : odometry.edges)
    edge.rejected = edge.rejected || edge.kind == EdgeKind::closure;
  const std::vector<int> component = connected_components(odometry);
  return std::all_of(component.begin(), component.end(), [](int c) { return c == 0; });
}

// Closures that disagree, over the loop through odometry, with most of the largest set that agrees.
std::vector<std::size_t> inconsistent_closures(const PoseGraph& graph, double probability) {
  std::vector<std::size_t> judged;
  std::vector<PairwiseClosure> pairwise;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (edge.kind != EdgeKind::closure || edge.rejected) continue;
    judged.push_back(k);
    pairwise.push_back(
        {edge.from, edge.to, {edge.T_from_to, bounded_information(edge.information).inverse()}});
  }
  const OdometryTree odometry(graph);
  const ChainFunction chain = [&](int from, int to) { return odometry.between(from, to); };
  const std::vector<int> largest =
      consistent_sets(pairwise, chain, chain, {probability}).sets.front();
  const double bound = chi_square_quantile_6(probability);
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < pairwise.size(); ++i) {
    const auto against = std::count_if(largest.begin(), largest.end(), [&](int j) {
      return static_cast<std::size_t>(j) != i &&
             pairwise_distance(pairwise[i], pairwise[static_cast<std::size_t>(j)], chain, chain) >
                 bound;
    });
    if (2 * static_cast<std::size_t>(against) > largest.size()) result.push_back(judged[i]);
  }
  return result;
}

// Judges the closures of a condensed graph at each scale asked of it.
class Search {
 public:
  Search(const CondensedGraph& condensed, const ScaleOptions& options, const Progress& progress)
      : condensed_(condensed), options_(options), progress_(progress) {
    for (const GraphEdge& edge : condensed.graph.edges)
      closures_ += edge.kind == EdgeKind::closure ? 1 : 0;
  }

  [[nodiscard]] bool has_answer() const { return closures_ > 0 && is_one_chain(condensed_.graph); }

  [[nodiscard]] ScaleTrial at(double log_scale) const {
    PoseGraph graph = condensed_.graph;
    scale_odometry(graph, std::exp(log_scale));
    const Evidence evidence(graph, options_.robust);
    const double deviation = log_scale > 0.0 ? kLogScaleUpward : kLogScaleDownward;
    const double prior = 0.5 * log_scale * log_scale / (deviation * deviation);
    ScaleTrial trial = judged(graph, evidence, {});
    // Among a few closures, or where few disagree, the largest set is decided by chance.
    constexpr std::size_t kFew = 6;
    constexpr double kManyRejected = 0.25;
    if (options_.pairwise_consistency && closures_ >= kFew &&
        static_cast<double>(closures_) - trial.accepted >=
            kManyRejected * static_cast<double>(closures_)) {
      ScaleTrial other =
          judged(graph, evidence, inconsistent_closures(graph, options_.robust.inlier_probability));
      if (other.log_evidence > trial.log_evidence) trial = std::move(other);
    }
    trial.scale = std::exp(log_scale);
    trial.log_evidence -= prior;
    return trial;
  }

 private:
  [[nodiscard]] ScaleTrial judged(PoseGraph graph, const Evidence& evidence,
                                  const std::vector<std::size_t>& inconsistent) const {
    ScaleTrial trial;
    for (const std::size_t k : inconsistent) {
      graph.edges[k].rejected = true;
      trial.inconsistent.push_back(condensed_.edge_of[k]);
    }
    trial.accepted = judge_closures(graph, options_.robust, progress_).accepted;
    trial.log_evidence = evidence.of(std::move(graph));
    return trial;
  }

  const CondensedGraph& condensed_;
  const ScaleOptions& options_;
  const Progress& progress_;
  std::size_t closures_ = 0;
};

}  // namespace

void scale_odometry(PoseGraph& graph, double scale) {
  for (GraphEdge& edge : graph.edges) {
    if (edge.kind == EdgeKind::odometry) edge.information /= scale * scale;
  }
}

OdometryScale estimate_odometry_scale(const PoseGraph& graph, const ScaleOptions& options,
                                      const Progress& progress) {
  OdometryScale result;
  const CondensedGraph condensed = condense_chains(graph);
  // Scales are tried at the same time; what they tell the caller comes one at a time.
  std::mutex telling;
  Progress told;
  if (progress) {
    told = [&](const std::string& stage, std::size_t done, std::size_t total) {
      const std::lock_guard lock(telling);
      progress(stage, done, total);
    };
  }
  const Search search(condensed, options, told);
  if (!search.has_answer()) return result;
  if (!options.estimate) {
    result.trials.push_back(search.at(0.0));
    return result;
  }
  const SingleThreadedAlgebra one_thread;  // each scale has one, whichever ends first
  result.trials.resize(kScales);
  parallel_for(kScales, 1, [&](std::size_t i) {
    result.trials[i] =
        search.at(std::log(kSmallest) + 0.5 * std::numbers::ln2 * static_cast<double>(i));
  });
  // The stated scale stands where no trial says anything.
  result.best = kStated;
  for (std::size_t i = 0; i < result.trials.size(); ++i) {
    const double evidence = result.trials[i].log_evidence;
    const double best = result.trials[result.best].log_evidence;
    if (std::isfinite(evidence) && (!std::isfinite(best) || evidence > best)) result.best = i;
  }
  result.scale = result.trials[result.best].scale;
  return result;
}

}  // namespace groundloop
