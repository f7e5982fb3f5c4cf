#include "backend/graph/chains.hpp"

#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "backend/graph/factors.hpp"
#include "backend/graph/relative_pose.hpp"
#include "frontend/core/union_find.hpp"

namespace groundloop {
namespace {

constexpr int kNone = -1;
constexpr int kMaxRounds = 20;
using BendMatrix = Eigen::Matrix<double, 6, 2>;

// Odometry edges at each vertex: two are remembered, more only counted.
struct Joint {
  std::array<int, 2> edge = {kNone, kNone};
  int count = 0;
};

// One edge of a run about the graph's values, in the run's direction: the later pose moves by
//   carry * (how the earlier moves) - residual - by_bend * (how the bend moves) + noise.
struct Step {
  int to = 0;
  Matrix6d carry;
  Vector6d residual;
  BendMatrix by_bend;
  Matrix6d covariance;
};

Step step_along(const PoseGraph& graph, const GraphEdge& edge, bool forward) {
  RelativePose measured{edge.T_from_to, edge.information.llt().solve(Matrix6d::Identity())};
  BendMatrix by_bend = edge.error_by_bend;
  if (!forward) {
    by_bend = (-adjoint(edge.T_from_to) * by_bend).eval();
    measured = inverse(measured);
  }
  Step step;
  step.to = forward ? edge.to : edge.from;
  const Pose now =
      graph.vertices[forward ? edge.from : edge.to].pose.inverse() * graph.vertices[step.to].pose;
  step.carry = adjoint(now.inverse());
  Vector6d r = log_se3(measured.T_from_to.inverse() * now);
  Matrix6d J = Matrix6d::Identity();  // of the later pose's movement by the residual
  if (r.squaredNorm() > 1e-20) J = right_jacobian_inverse_se3(r).inverse();
  if (edge.bend >= 0) r += by_bend * graph.bends[edge.bend];
  step.residual = J * r;
  step.by_bend = J * by_bend;
  step.covariance = J * measured.covariance * J.transpose();
  return step;
}

// A whole run: the same, from its first pose to its last.
struct Run {
  Matrix6d carry = Matrix6d::Identity();
  Vector6d residual = Vector6d::Zero();
  BendMatrix by_bend = BendMatrix::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  void add(const Step& step) {
    carry = (step.carry * carry).eval();
    residual = (step.carry * residual).eval() + step.residual;
    by_bend = (step.carry * by_bend).eval() + step.by_bend;
    covariance = (step.carry * covariance * step.carry.transpose()).eval() + step.covariance;
  }
};

// The run as a measurement whose residual and derivatives are the run's.
GraphEdge edge_of(const PoseGraph& graph, const Run& run, int from, int to, int bend) {
  GraphEdge edge;
  edge.bend = bend;
  Vector6d r = run.residual;
  if (bend >= 0) r -= run.by_bend * graph.bends[bend];
  edge.T_from_to = graph.vertices[from].pose.inverse() * graph.vertices[to].pose * exp_se3(-r);
  const Matrix6d J_inverse = right_jacobian_inverse_se3(r);
  const Matrix6d J = J_inverse.inverse();
  edge.error_by_bend = J_inverse * run.by_bend;
  const Matrix6d information = J.transpose() * run.covariance.llt().solve(Matrix6d::Identity()) * J;
  edge.information = 0.5 * (information + information.transpose());
  return edge;
}

class Condenser {
 public:
  Condenser(const PoseGraph& graph, const std::vector<char>& keep)
      : graph_(graph), joints_(graph.vertices.size()), trees_(graph.vertices.size()) {
    keep_.assign(graph.vertices.size(), 0);
    used_.assign(graph.edges.size(), 0);
    const std::vector<int> component = connected_components(graph);
    int next_component = 0;
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      const bool first = component[i] == next_component;
      if (first) ++next_component;
      keep_[i] = first || graph.vertices[i].fixed || (!keep.empty() && keep[i]);
    }
    for (const VerticalFactor& v : graph.verticals) keep_[v.vertex] = 1;
    for (const PosePrior& p : graph.priors) keep_[p.vertex] = 1;
    for (std::size_t k = 0; k < graph.edges.size(); ++k) note_edge(static_cast<int>(k));
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      const Joint& joint = joints_[i];
      if (joint.count != 2 || graph.edges[joint.edge[0]].bend != graph.edges[joint.edge[1]].bend)
        keep_[i] = 1;
    }
  }

  CondensedGraph run() {
    std::vector<int> position(keep_.size(), kNone);
    CondensedGraph result;
    PoseGraph& small = result.graph;
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      if (!keep_[i]) continue;
      position[i] = static_cast<int>(result.kept.size());
      result.kept.push_back(static_cast<int>(i));
      small.vertices.push_back(graph_.vertices[i]);
    }
    small.bends = graph_.bends;
    small.ups = graph_.ups;
    small.verticals = graph_.verticals;
    for (VerticalFactor& v : small.verticals) v.vertex = position[v.vertex];
    small.priors = graph_.priors;
    for (PosePrior& p : small.priors) p.vertex = position[p.vertex];
    small.bend_priors = graph_.bend_priors;
    for (std::size_t k = 0; k < graph_.edges.size(); ++k) {
      const GraphEdge& edge = graph_.edges[k];
      if (edge.rejected || used_[k] || !(keep_[edge.from] || keep_[edge.to])) continue;
      std::vector<std::size_t> run{k};
      const bool whole = keep_[edge.from] && keep_[edge.to];
      GraphEdge condensed =
          whole ? edge : walk(keep_[edge.from] ? edge.from : edge.to, static_cast<int>(k), run);
      condensed.from = position[condensed.from];
      condensed.to = position[condensed.to];
      small.edges.push_back(condensed);
      result.edge_of.push_back(k);
      result.runs.push_back(std::move(run));
    }
    return result;
  }

 private:
  void note_edge(int k) {
    const GraphEdge& edge = graph_.edges[k];
    if (edge.rejected) return;
    bool joins = edge.kind == EdgeKind::odometry && edge.weight == 1.0 &&
                 edge.information.llt().info() == Eigen::Success;
    // An edge that closes a ring of trusted edges keeps its ends: a run round the ring would end
    // where it began.
    joins = joins && trees_.join(edge.from, edge.to);
    for (const int vertex : {edge.from, edge.to}) {
      if (!joins) keep_[vertex] = 1;
      Joint& joint = joints_[vertex];
      if (joint.count < 2) joint.edge[joint.count] = k;
      ++joint.count;
    }
  }

  // The edge from the kept vertex `start` through edge `k` and on to the next kept vertex.
  GraphEdge walk(int start, int k, std::vector<std::size_t>& edges) {
    Run run;
    edges.clear();
    int vertex = start;
    const int bend = graph_.edges[k].bend;
    for (;;) {
      used_[k] = 1;
      edges.push_back(static_cast<std::size_t>(k));
      const Step step = step_along(graph_, graph_.edges[k], graph_.edges[k].from == vertex);
      run.add(step);
      vertex = step.to;
      if (keep_[vertex]) break;
      const Joint& joint = joints_[vertex];
      k = joint.edge[0] == k ? joint.edge[1] : joint.edge[0];
    }
    GraphEdge result = edge_of(graph_, run, start, vertex, bend);
    result.from = start;
    result.to = vertex;
    return result;
  }

  const PoseGraph& graph_;
  std::vector<Joint> joints_;
  UnionFind trees_;  // that trusted edges form
  std::vector<char> keep_;
  std::vector<char> used_;
};

// Moves the inner poses of a run, whose ends and bend have moved.
void fill_run(const std::vector<std::size_t>& edges, int start, const Vector6d& start_moved,
              const Vector6d& end_moved, const Bend& bend_moved, PoseGraph& graph) {
  std::vector<Step> steps;
  Run whole;
  std::vector<Vector6d> moved{start_moved};  // by the ends' and the bend's movement alone
  int vertex = start;
  for (const std::size_t k : edges) {
    steps.push_back(step_along(graph, graph.edges[k], graph.edges[k].from == vertex));
    vertex = steps.back().to;
    whole.add(steps.back());
  }
  // What the noise of all steps together must have been, seen at the end.
  const Vector6d noise =
      end_moved - whole.carry * start_moved + whole.residual + whole.by_bend * bend_moved;
  Vector6d dual = whole.covariance.llt().solve(noise);
  std::vector<Vector6d> shares(steps.size());
  for (std::size_t k = steps.size(); k-- > 0;) {
    shares[k] = steps[k].covariance * dual;
    dual = (steps[k].carry.transpose() * dual).eval();
  }
  Vector6d move = start_moved;
  for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
    move = (steps[k].carry * move).eval() - steps[k].residual - steps[k].by_bend * bend_moved +
           shares[k];
    Pose& pose = graph.vertices[steps[k].to].pose;
    pose = pose * exp_se3(move);
  }
}

}  // namespace

CondensedGraph condense_chains(const PoseGraph& graph, const std::vector<char>& keep) {
  return Condenser(graph, keep).run();
}

void fill_in(const CondensedGraph& condensed, PoseGraph& graph) {
  const PoseGraph& small = condensed.graph;
  std::vector<Vector6d> moved(small.vertices.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Pose& before = graph.vertices[condensed.kept[i]].pose;
    moved[i] = log_se3(before.inverse() * small.vertices[i].pose);
  }
  for (std::size_t k = 0; k < small.edges.size(); ++k) {
    const GraphEdge& edge = small.edges[k];
    if (condensed.runs[k].size() < 2) continue;
    Bend bend_moved = Bend::Zero();
    if (edge.bend >= 0) bend_moved = small.bends[edge.bend] - graph.bends[edge.bend];
    fill_run(condensed.runs[k], condensed.kept[edge.from], moved[edge.from], moved[edge.to],
             bend_moved, graph);
  }
  for (std::size_t i = 0; i < moved.size(); ++i)
    graph.vertices[condensed.kept[i]].pose = small.vertices[i].pose;
  graph.bends = small.bends;
  graph.ups = small.ups;
}

SolveReport solve_condensed(PoseGraph& graph, const std::vector<char>& held,
                            const SolveOptions& options, const Progress& progress) {
  SolveReport report;
  double before = cost(graph);
  for (int round = 0; round < kMaxRounds; ++round) {
    CondensedGraph condensed = condense_chains(graph, held);
    std::vector<char> small_held;
    for (const int i : condensed.kept) small_held.push_back(held[i]);
    const int iterations = report.iterations;
    report = solve(condensed.graph, small_held, options, progress);
    report.iterations += iterations;
    fill_in(condensed, graph);
    const double now = report.cost = cost(graph);
    if (std::abs(before - now) <= options.function_tolerance * now) break;
    before = now;
  }
  return report;
}

}  // namespace groundloop
