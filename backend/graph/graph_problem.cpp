#include "backend/graph/graph_problem.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include <ceres/ceres.h>

#include "backend/graph/single_threaded_algebra.hpp"

namespace groundloop {
namespace {

constexpr int kAmbient = 7;  // qx qy qz qw tx ty tz
constexpr int kTangent = 6;

Pose load(const double* x) {
  Pose pose;
  pose.rotation.coeffs() = Eigen::Map<const Eigen::Vector4d>(x);
  pose.translation = Eigen::Map<const Eigen::Vector3d>(x + 4);
  return pose;
}

void store(const Pose& pose, double* x) {
  std::copy_n(pose.rotation.coeffs().data(), 4, x);
  std::copy_n(pose.translation.data(), 3, x + 4);
}

using AmbientJacobian = Eigen::Matrix<double, kTangent, kAmbient, Eigen::RowMajor>;

// x plus d is x exp(d). Ceres multiplies a residual's Jacobian by the ambient coordinates with
// PlusJacobian; BetweenCost gives its Jacobian by the tangent in the first six columns instead, and
// PlusJacobian hands these on unchanged, so that nothing is projected back and forth.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kAmbient; }
  int TangentSize() const override { return kTangent; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    store(load(x) * exp_se3(Eigen::Map<const Vector6d>(delta)), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kAmbient, kTangent, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> difference(y_minus_x);
    difference = log_se3(load(x).inverse() * load(y));
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<AmbientJacobian>(jacobian).setIdentity();
    return true;
  }
};

class BetweenCost final : public ceres::SizedCostFunction<kTangent, kAmbient, kAmbient> {
 public:
  explicit BetweenCost(const GraphEdge& edge)
      : edge_(edge), whitening_(whitening(edge.information)) {}

  bool Evaluate(const double* const* poses, double* residuals, double** jacobians) const override {
    const Pose from = load(poses[0]);
    const Pose to = load(poses[1]);
    const Matrix6d W = std::sqrt(edge_.weight) * whitening_;
    Eigen::Map<Vector6d> r(residuals);
    if (jacobians == nullptr) {
      r.noalias() = W * between_residual(from, to, edge_.T_from_to);
      return true;
    }
    Matrix6d J[2];
    r.noalias() = W * between_residual(from, to, edge_.T_from_to, J[0], J[1]);
    for (int i = 0; i < 2; ++i) {
      if (jacobians[i] == nullptr) continue;
      Eigen::Map<AmbientJacobian> out(jacobians[i]);
      out.leftCols<kTangent>().noalias() = W * J[i];
      out.col(kTangent).setZero();
    }
    return true;
  }

 private:
  const GraphEdge& edge_;
  Matrix6d whitening_;
};

class ProgressCallback final : public ceres::IterationCallback {
 public:
  ProgressCallback(const Progress& progress, int max_iterations)
      : progress_(progress), max_iterations_(max_iterations) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    progress_("optimisation", static_cast<std::size_t>(summary.iteration),
              static_cast<std::size_t>(max_iterations_));
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const Progress& progress_;
  int max_iterations_;
};

}  // namespace

struct GraphProblem::Parts {
  PoseGraph& graph;
  std::vector<double> parameters;
  PoseManifold manifold;
  std::deque<BetweenCost> costs;  // Ceres keeps pointers into it
  std::unique_ptr<ceres::Problem> problem;
};

GraphProblem::GraphProblem(PoseGraph& graph, const std::vector<EdgeEnds>& ends,
                           const std::vector<char>& fixed)
    : parts_(new Parts{graph, std::vector<double>(graph.vertices.size() * kAmbient), {}, {}, {}}) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  parts_->problem = std::make_unique<ceres::Problem>(options);
  ceres::Problem& problem = *parts_->problem;
  const auto block = [&](int vertex) { return &parts_->parameters[vertex * kAmbient]; };
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    problem.AddParameterBlock(block(static_cast<int>(i)), kAmbient, &parts_->manifold);
    if (fixed[i]) problem.SetParameterBlockConstant(block(static_cast<int>(i)));
  }
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    if (graph.edges[k].rejected) continue;
    parts_->costs.emplace_back(graph.edges[k]);
    problem.AddResidualBlock(&parts_->costs.back(), nullptr, block(ends[k].from),
                             block(ends[k].to));
  }
}

GraphProblem::~GraphProblem() = default;

SolveReport GraphProblem::solve(const SolveOptions& options, const Progress& progress) {
  std::vector<GraphVertex>& vertices = parts_->graph.vertices;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    store(vertices[i].pose, &parts_->parameters[i * kAmbient]);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  // Nearly undamped from the start: near the optimum damping costs iterations along the weak
  // directions of a graph (14 instead of 3 on parking-garage), and far from it a rejected step or
  // two bring the damping.
  solver.initial_trust_region_radius = 1e10;
  // Relative to the poses' coordinates, which say nothing of convergence.
  solver.parameter_tolerance = 0.0;
  solver.num_threads = 1;  // its sums depend on the number of threads
  solver.logging_type = ceres::SILENT;
  ProgressCallback callback(progress, options.max_iterations);
  if (progress) solver.callbacks.push_back(&callback);

  const SingleThreadedAlgebra one_thread;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, parts_->problem.get(), &summary);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i].pose = load(&parts_->parameters[i * kAmbient]);
  }
  SolveReport report;
  report.cost = summary.final_cost;
  report.iterations = static_cast<int>(summary.iterations.size()) - 1;
  report.converged = summary.termination_type == ceres::CONVERGENCE;
  report.termination = summary.message;
  return report;
}

}  // namespace groundloop
