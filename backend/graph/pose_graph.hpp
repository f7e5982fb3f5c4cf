// A pose graph: what is to be found, and the facts that say so, its factors. Found are the poses of
// scans, the bend of each recording's odometry, and which way is up in each frame. Which kinds of
// facts there are, and what each costs, stands in factors.hpp; solving in solver.hpp; files in
// g2o_file.hpp.
//
// Convention everywhere: tangent vectors are ordered (translation, rotation) in metres and radians
// and perturb a pose on the right; the information of a measured pose belongs to such a
// perturbation; cost = 1/2 sum weight * r' information r.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frontend/core/pose.hpp"

namespace groundloop {

struct GraphVertex {
  int id = 0;          ///< of the file, or the scan's number; edges do not use it
  Pose pose;           ///< T_world_vertex
  bool fixed = false;  ///< held by the solver
};

/// What the odometry of a recording adds to each metre of its way, in rad/m: a tilt that bends the
/// world up or down in every direction alike (the sensor's beams point too high or low), and a turn
/// about the vertical.
using Bend = Eigen::Vector2d;

/// A settled edge is a closure that was judged before and is taken as it is.
enum class EdgeKind { odometry, closure, settled };

/// A measured relative pose: an odometry step, a chain of them, or a closure (between_factor.hpp).
struct GraphEdge {
  int from = 0;  ///< positions in PoseGraph::vertices
  int to = 0;
  Pose T_from_to;
  Matrix6d information = Matrix6d::Identity();
  EdgeKind kind = EdgeKind::odometry;
  double weight = 1.0;    ///< factor on the information, set by the robust solver, in [0, 1]
  bool rejected = false;  ///< true where the robust solver left the edge out
  int bend = -1;          ///< position in PoseGraph::bends of the recording's; -1: none
  /// Error of the measurement, a perturbation on its right, for a unit of bend.
  Eigen::Matrix<double, 6, 2> error_by_bend = Eigen::Matrix<double, 6, 2>::Zero();
};

/// Which way is up, seen from a pose (vertical_factor.hpp).
struct VerticalFactor {
  int vertex = 0;
  int frame = 0;  ///< position in PoseGraph::ups
  /// Square root of the information (1/rad) over the components of a direction across the vertical
  /// that was seen, in the vertex's frame: what is left of the true vertical is the error.
  Eigen::Matrix<double, 2, 3> whitening = Eigen::Matrix<double, 2, 3>::Zero();
  double weight = 1.0;
};

/// A pose known beforehand (priors.cpp).
struct PosePrior {
  int vertex = 0;
  Pose T_world_vertex;
  Matrix6d information = Matrix6d::Identity();
};

/// How large a bend may be before anything is seen: a normal distribution about zero.
struct BendPrior {
  int bend = 0;
  Bend deviation = Bend::Zero();  ///< rad/m, positive
};

struct PoseGraph {
  std::vector<GraphVertex> vertices;
  std::vector<Bend> bends;           ///< of recordings; held where no prior makes them free
  std::vector<Eigen::Vector3d> ups;  ///< unit vectors, of frames; held where no vertical is seen

  std::vector<GraphEdge> edges;
  std::vector<VerticalFactor> verticals;
  std::vector<PosePrior> priors;
  std::vector<BendPrior> bend_priors;
};

/// What is wrong with a measurement, in words ("information is not positive semi-definite"), or
/// empty. Semi-definite is judged up to rounding: eigenvalues down to -1e-9 of the largest pass.
[[nodiscard]] std::string defect_of(const GraphEdge& edge);

/// Throws InputError naming the vertex or edge where an edge leaves the graph or joins a vertex
/// with itself, a number is not finite, or an information matrix is not symmetric positive
/// semi-definite. Repeated edges between the same vertices are allowed; their costs add.
void check_graph(const PoseGraph& graph);

/// Component of each vertex, numbered from 0 by first vertex, over the edges that are not rejected.
[[nodiscard]] std::vector<int> connected_components(const PoseGraph& graph);

/// The gauge: 1 for each vertex that a solver holds, which are those marked fixed and the first of
/// each component that has none, nor a prior.
[[nodiscard]] std::vector<char> gauge(const PoseGraph& graph);

/// Calls an edge odometry where it joins ids that follow one another among the graph's sorted ids,
/// and a closure otherwise: the rule for graphs whose edges carry no kind, such as g2o files.
void classify_edges_by_successive_ids(PoseGraph& graph);

}  // namespace groundloop
