// A pose graph: poses to be found and measured relative poses between them, each with its
// information. Checks, the between residual with its analytic Jacobians, and the two costs of
// design.md section 4 are here; solving is in optimizer.hpp, files are in g2o_file.hpp.
//
// Convention everywhere: r = log_se3(T_from_to^-1 * T_world_from^-1 * T_world_to), ordered
// (translation, rotation) in metres and radians; cost = 1/2 sum weight * r' information r. The
// information belongs to a perturbation of the measurement on the right.
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

#include "frontend/core/pose.hpp"

namespace groundloop {

enum class EdgeKind { odometry, closure };

struct GraphVertex {
  int id = 0;
  Pose pose;           ///< T_world_vertex
  bool fixed = false;  ///< held by the solver
};

struct GraphEdge {
  int from = 0;
  int to = 0;
  Pose T_from_to;
  Matrix6d information = Matrix6d::Identity();
  EdgeKind kind = EdgeKind::odometry;
  double weight = 1.0;    ///< factor on the information, set by the robust solver, in [0, 1]
  bool rejected = false;  ///< true where the robust solver left the edge out
};

struct PoseGraph {
  std::vector<GraphVertex> vertices;
  std::vector<GraphEdge> edges;
};

/// Ends of an edge as positions in PoseGraph::vertices.
struct EdgeEnds {
  int from = 0;
  int to = 0;
};

/// What is wrong with a measurement, in words ("information is not positive semi-definite"), or
/// empty. Semi-definite is judged up to rounding: eigenvalues down to -1e-9 of the largest pass.
[[nodiscard]] std::string defect_of(const GraphEdge& edge);

/// Checks the whole graph and resolves ids. Throws InputError naming the vertex or edge where an id
/// occurs twice, an edge names a vertex that is not there or joins one with itself, a number is not
/// finite, or an information matrix is not symmetric positive semi-definite. Repeated edges between
/// the same vertices are allowed; their costs add.
[[nodiscard]] std::vector<EdgeEnds> resolve_edges(const PoseGraph& graph);

/// Component of each vertex, numbered from 0 by first vertex, over the edges that are not rejected.
[[nodiscard]] std::vector<int> connected_components(const PoseGraph& graph,
                                                    const std::vector<EdgeEnds>& ends);

/// Calls an edge odometry where it joins ids that follow one another among the graph's sorted ids,
/// and a closure otherwise: the rule for graphs whose edges carry no kind, such as g2o files.
void classify_edges_by_successive_ids(PoseGraph& graph);

/// The residual r (see above), without weight or information.
[[nodiscard]] Vector6d between_residual(const Pose& T_world_from, const Pose& T_world_to,
                                        const Pose& T_from_to);
/// The same with its derivatives by perturbations on the right of both poses.
Vector6d between_residual(const Pose& T_world_from, const Pose& T_world_to, const Pose& T_from_to,
                          Matrix6d& J_from, Matrix6d& J_to);

/// W with W' W = information, so that |W r|^2 = r' information r. It is the transposed Cholesky
/// factor, or, for a singular matrix, the square root of the eigenvalues times the eigenvectors.
[[nodiscard]] Matrix6d whitening(const Matrix6d& information);

/// 1/2 sum r' information r over the edges, each times its weight, rejected ones left out.
[[nodiscard]] double cost(const PoseGraph& graph);
/// g2o's own chi-square over the same edges: sum e' information e with e the translation and the
/// quaternion's vector part (w >= 0) of the residual pose.
[[nodiscard]] double chi2_g2o(const PoseGraph& graph);

}  // namespace groundloop
