// The kinds of facts that a pose graph holds, listed here and nowhere else, and what each gives to
// the solver. A new kind is a struct in PoseGraph, a file with its linearise(), and a line in
// for_each_kind(); solving, costs and covariances follow.
//
// | kind          | residual                                 | rows | information, where it is from
// | | ------------- | ---------------------------------------- | ---- |
// ----------------------------- | | odometry step | log(Z^-1 T_from^-1 T_to) + error by bend | 6 |
// registration and random walk  | | closure       | log(Z^-1 T_from^-1 T_to)                 | 6 |
// registration of two maps      | | vertical      | the true vertical across the one seen    | 2 |
// upright surfaces of a map     | | pose prior    | log(Z^-1 T)                              | 6 |
// whoever knows the pose        | | bend prior    | the bend                                 | 2 |
// its likely size               |
#pragma once

#include <array>

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// Variables are numbered through: poses, then ups, then bends.
[[nodiscard]] inline int up_variable(const PoseGraph& graph, int up) {
  return static_cast<int>(graph.vertices.size()) + up;
}
[[nodiscard]] inline int bend_variable(const PoseGraph& graph, int bend) {
  return static_cast<int>(graph.vertices.size() + graph.ups.size()) + bend;
}
/// Unknowns of a variable.
[[nodiscard]] inline int size_of_variable(const PoseGraph& graph, int variable) {
  return variable < static_cast<int>(graph.vertices.size()) ? 6 : 2;
}

/// A factor about the graph's values: residual + sum of J times the perturbations of its variables,
/// in the metric `information`, which holds the weight. What a kind does not use is zero.
struct Linearised {
  struct Block {
    int variable = -1;
    Matrix6d J = Matrix6d::Zero();  ///< rows of the residual, columns of the variable
  };
  int blocks = 0;
  std::array<Block, 3> block;
  Vector6d residual = Vector6d::Zero();
  Matrix6d information = Matrix6d::Zero();
};

[[nodiscard]] Linearised linearise(const PoseGraph& graph, const GraphEdge& edge);
[[nodiscard]] Linearised linearise(const PoseGraph& graph, const VerticalFactor& vertical);
[[nodiscard]] Linearised linearise(const PoseGraph& graph, const PosePrior& prior);
[[nodiscard]] Linearised linearise(const PoseGraph& graph, const BendPrior& prior);

/// 1/2 r' information r of one factor, weight included.
[[nodiscard]] double cost(const PoseGraph& graph, const GraphEdge& edge);
[[nodiscard]] double cost(const PoseGraph& graph, const VerticalFactor& vertical);
[[nodiscard]] double cost(const PoseGraph& graph, const PosePrior& prior);
[[nodiscard]] double cost(const PoseGraph& graph, const BendPrior& prior);

/// False for factors that are no part of the problem.
[[nodiscard]] inline bool counts(const GraphEdge& edge) { return !edge.rejected; }
template <typename Factor>
[[nodiscard]] bool counts(const Factor&) {
  return true;
}

/// Calls f(factors) for the list of each kind.
template <typename F>
void for_each_kind(const PoseGraph& graph, F&& f) {
  f(graph.edges);
  f(graph.verticals);
  f(graph.priors);
  f(graph.bend_priors);
}

/// Sum over all factors that count.
[[nodiscard]] double cost(const PoseGraph& graph);

/// Moves a variable by its part of a step.
void perturb(PoseGraph& graph, int variable, const Vector6d& step);

}  // namespace groundloop
