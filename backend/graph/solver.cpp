#include "backend/graph/solver.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

#include "backend/graph/factors.hpp"
#include "backend/graph/single_threaded_algebra.hpp"
#include "backend/graph/vertical_factor.hpp"

namespace groundloop {
namespace {

// Coordinates of a variable as Ceres keeps it: qx qy qz qw tx ty tz, an up, a bend.
constexpr int kPose = 7;
constexpr int kUp = 3;
constexpr int kBend = 2;

template <typename Derived>
void store(const Eigen::MatrixBase<Derived>& from, double* to) {
  for (Eigen::Index i = 0; i < from.size(); ++i) to[i] = from[i];
}
void store(const Pose& pose, double* to) {
  store(pose.rotation.coeffs(), to);
  store(pose.translation, to + 4);
}
Pose load_pose(const double* from) {
  Pose pose;
  pose.rotation.coeffs() = Eigen::Map<const Eigen::Vector4d>(from);
  pose.translation = Eigen::Map<const Eigen::Vector3d>(from + 4);
  return pose;
}

// Ceres multiplies a residual's Jacobian by the coordinates with PlusJacobian. Here the Jacobian by
// the perturbation stands in the first columns instead, and PlusJacobian hands it on unchanged, so
// that nothing is projected back and forth.
template <int kAmbient, int kTangent>
class PerturbedOnTheRight : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kAmbient; }
  int TangentSize() const override { return kTangent; }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kAmbient, kTangent, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kTangent, kAmbient, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

class PoseManifold final : public PerturbedOnTheRight<kPose, 6> {
 public:
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    store(load_pose(x) * exp_se3(Eigen::Map<const Vector6d>(delta)), x_plus_delta);
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    store(log_se3(load_pose(x).inverse() * load_pose(y)), y_minus_x);
    return true;
  }
};

class UpManifold final : public PerturbedOnTheRight<kUp, 2> {
 public:
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Vector3d up = Eigen::Map<const Eigen::Vector3d>(x);
    store((up + across(up) * Eigen::Map<const Eigen::Vector2d>(delta)).normalized(), x_plus_delta);
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    store(across(Eigen::Map<const Eigen::Vector3d>(x)).transpose() *
              Eigen::Map<const Eigen::Vector3d>(y),
          y_minus_x);
    return true;
  }
};

// A root W of information: W' W is it. Semi-definite ones have one, too.
Matrix6d root_of(const Matrix6d& information) {
  const Eigen::LDLT<Matrix6d> ldlt(information);
  const Matrix6d L = ldlt.matrixL();
  // Transpositions from the left only: Eigen 3.4 applies those from the right in the wrong order.
  const Matrix6d pivoted = ldlt.transpositionsP().transpose() * L;
  return ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal() * pivoted.transpose();
}

// The coordinates of all variables, numbered as in factors.hpp.
class Coordinates {
 public:
  explicit Coordinates(const PoseGraph& graph)
      : poses_(graph.vertices.size()), ups_(graph.ups.size()), bends_(graph.bends.size()) {
    values_.resize(kPose * poses_ + kUp * ups_ + kBend * bends_);
    for (std::size_t i = 0; i < poses_; ++i) store(graph.vertices[i].pose, of(i));
    for (std::size_t i = 0; i < ups_; ++i) store(graph.ups[i], of(poses_ + i));
    for (std::size_t i = 0; i < bends_; ++i) store(graph.bends[i], of(poses_ + ups_ + i));
  }
  void write(PoseGraph& graph) const {
    for (std::size_t i = 0; i < poses_; ++i) graph.vertices[i].pose = load_pose(of(i));
    for (std::size_t i = 0; i < ups_; ++i)
      graph.ups[i] = Eigen::Map<const Eigen::Vector3d>(of(poses_ + i));
    for (std::size_t i = 0; i < bends_; ++i)
      graph.bends[i] = Eigen::Map<const Eigen::Vector2d>(of(poses_ + ups_ + i));
  }
  [[nodiscard]] double* of(std::size_t variable) {
    return const_cast<double*>(std::as_const(*this).of(variable));
  }
  [[nodiscard]] const double* of(std::size_t variable) const {
    if (variable < poses_) return &values_[kPose * variable];
    const std::size_t up = variable - poses_;
    if (up < ups_) return &values_[kPose * poses_ + kUp * up];
    return &values_[kPose * poses_ + kUp * ups_ + kBend * (up - ups_)];
  }
  [[nodiscard]] int size_of(std::size_t variable) const {
    return variable < poses_ ? kPose : variable < poses_ + ups_ ? kUp : kBend;
  }
  [[nodiscard]] std::size_t variables() const { return poses_ + ups_ + bends_; }

 private:
  std::size_t poses_, ups_, bends_;
  std::vector<double> values_;
};

// A factor of any kind. The values it is evaluated at are those of the graph, which PutIntoGraph
// keeps up to date.
template <typename Factor>
class FactorCost final : public ceres::CostFunction {
 public:
  FactorCost(const PoseGraph& graph, const Factor& factor, const Linearised& at_start,
             const Coordinates& coordinates)
      : graph_(graph), factor_(factor), root_(root_of(at_start.information)) {
    for (int b = 0; b < at_start.blocks; ++b) {
      const int variable = at_start.block[b].variable;
      mutable_parameter_block_sizes()->push_back(
          coordinates.size_of(static_cast<std::size_t>(variable)));
      tangents_.push_back(size_of_variable(graph, variable));
    }
    set_num_residuals(static_cast<int>(root_.rows()));
  }

  bool Evaluate(const double* const*, double* residuals, double** jacobians) const override {
    const Linearised l = linearise(graph_, factor_);
    Eigen::Map<Vector6d>(residuals).noalias() = root_ * l.residual;
    if (jacobians == nullptr) return true;
    for (int b = 0; b < l.blocks; ++b) {
      if (jacobians[b] == nullptr) continue;
      using RowMajor = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor> J(jacobians[b], 6, parameter_block_sizes()[b]);
      J.setZero();
      J.leftCols(tangents_[b]).noalias() = root_ * l.block[b].J.leftCols(tangents_[b]);
    }
    return true;
  }

 private:
  const PoseGraph& graph_;
  const Factor& factor_;
  Matrix6d root_;
  std::vector<int> tangents_;
};

class PutIntoGraph final : public ceres::EvaluationCallback {
 public:
  PutIntoGraph(const Coordinates& coordinates, PoseGraph& graph)
      : coordinates_(coordinates), graph_(graph) {}
  void PrepareForEvaluation(bool, bool new_point) override {
    if (new_point) coordinates_.write(graph_);
  }

 private:
  const Coordinates& coordinates_;
  PoseGraph& graph_;
};

class TellProgress final : public ceres::IterationCallback {
 public:
  TellProgress(const Progress& progress, int most) : progress_(progress), most_(most) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    progress_("optimisation", static_cast<std::size_t>(summary.iteration),
              static_cast<std::size_t>(most_));
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const Progress& progress_;
  int most_;
};

ceres::Problem::Options problem_options(PutIntoGraph& callback) {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = &callback;
  return options;
}

ceres::Solver::Options solver_options(const SolveOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  // Nearly undamped from the start: near the optimum damping costs iterations along the weak
  // directions of a graph (14 instead of 3 on parking-garage), and far from it a rejected step or
  // two bring the damping.
  solver.initial_trust_region_radius = 1e10;
  // Relative to the coordinates, which say nothing of convergence.
  solver.parameter_tolerance = 0.0;
  solver.num_threads = 1;  // its sums depend on the number of threads
  solver.logging_type = ceres::SILENT;
  return solver;
}

}  // namespace

SolveReport solve(PoseGraph& graph, const std::vector<char>& held, const SolveOptions& options,
                  const Progress& progress) {
  Coordinates coordinates(graph);
  PutIntoGraph put_into_graph(coordinates, graph);
  PoseManifold pose_manifold;
  UpManifold up_manifold;
  ceres::Problem problem(problem_options(put_into_graph));
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    problem.AddParameterBlock(coordinates.of(i), kPose, &pose_manifold);
    if (held[i] != 0) problem.SetParameterBlockConstant(coordinates.of(i));
  }
  std::vector<char> free(coordinates.variables(), 0);
  for (std::size_t i = graph.vertices.size(); i < coordinates.variables(); ++i)
    problem.AddParameterBlock(coordinates.of(i), coordinates.size_of(i),
                              coordinates.size_of(i) == kUp ? &up_manifold : nullptr);
  // Ups are unknown where a vertical is seen, bends where a prior makes them free.
  for (const VerticalFactor& v : graph.verticals) free[up_variable(graph, v.frame)] = 1;
  for (const BendPrior& p : graph.bend_priors) free[bend_variable(graph, p.bend)] = 1;
  for (std::size_t i = graph.vertices.size(); i < coordinates.variables(); ++i) {
    if (free[i] == 0) problem.SetParameterBlockConstant(coordinates.of(i));
  }
  for_each_kind(graph, [&]<typename Factor>(const std::vector<Factor>& factors) {
    for (const Factor& factor : factors) {
      if (!counts(factor)) continue;
      const Linearised l = linearise(graph, factor);
      std::vector<double*> blocks;
      for (int b = 0; b < l.blocks; ++b)
        blocks.push_back(coordinates.of(static_cast<std::size_t>(l.block[b].variable)));
      problem.AddResidualBlock(new FactorCost<Factor>(graph, factor, l, coordinates), nullptr,
                               blocks);
    }
  });
  ceres::Solver::Options solver = solver_options(options);
  TellProgress tell(progress, options.max_iterations);
  if (progress) solver.callbacks.push_back(&tell);
  const SingleThreadedAlgebra one_thread;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  coordinates.write(graph);
  SolveReport report;
  report.cost = summary.final_cost;
  report.iterations = static_cast<int>(summary.iterations.size()) - 1;
  report.converged = summary.termination_type == ceres::CONVERGENCE;
  report.termination = summary.message;
  return report;
}

}  // namespace groundloop
