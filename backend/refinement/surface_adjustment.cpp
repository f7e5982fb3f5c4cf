#include "backend/refinement/surface_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

using Matrix63d = Eigen::Matrix<double, 6, 3>;
using Matrix46d = Eigen::Matrix<double, 4, 6>;
using Matrix43d = Eigen::Matrix<double, 4, 3>;

// What one surface says of the submaps that saw it, its plane eliminated.
struct SurfaceTerm {
  std::vector<Matrix6d> own;     // J' J of each part
  std::vector<Matrix63d> cross;  // J' J_plane of each part
  std::vector<Vector6d> gradient;
  Eigen::Matrix3d plane_inverse = Eigen::Matrix3d::Zero();
  double cost = 0.0;
};

// The square root of a part's mean moments, in its submap's frame.
Eigen::Matrix4d root_of_moments(const SurfacePart& part) {
  const double n = part.moments.count();
  const Eigen::Vector3d mean = part.moments.mean();
  // [C + m m', m; m', 1] = L L' with C = A A': L = [A, m; 0, 1].
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(part.moments.covariance());
  Eigen::Matrix4d root = Eigen::Matrix4d::Zero();
  root.topLeftCorner<3, 3>() =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  root.topRightCorner<3, 1>() = mean;
  root(3, 3) = n > 0.0 ? 1.0 : 0.0;
  return root;
}

// An orthonormal basis of the plane across n.
Eigen::Matrix<double, 3, 2> basis_across(const Eigen::Vector3d& n) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = n.unitOrthogonal();
  basis.col(1) = n.cross(basis.col(0));
  return basis;
}

// The plane of the weighted parts and their robust weights, found in turn.
struct WeightedPlane {
  Eigen::Vector3d centre, normal;
  std::vector<double> weights;  // information of each part, the kernel's share in it
  double cost = 0.0;
};

WeightedPlane weighted_plane(const Surface& surface, const std::vector<Pose>& T_world_submap,
                             const SurfaceAdjustmentOptions& options) {
  const std::size_t k = surface.parts.size();
  const Eigen::Vector3d origin = T_world_submap[surface.parts.front().submap].translation;
  std::vector<double> information(k);
  std::vector<Eigen::Vector3d> means(k);
  std::vector<Eigen::Matrix3d> covariances(k);
  for (std::size_t i = 0; i < k; ++i) {
    const SurfacePart& part = surface.parts[i];
    const Pose& T = T_world_submap[part.submap];
    const double n = part.moments.count();
    information[i] = 1.0 / (options.point_deviation * options.point_deviation / n +
                            options.submap_deviation * options.submap_deviation);
    const Eigen::Matrix3d R = T.rotation_matrix();
    means[i] = R * part.moments.mean() + (T.translation - origin);
    covariances[i] = R * part.moments.covariance() * R.transpose();
  }
  WeightedPlane plane;
  plane.weights = information;
  const double scale = options.kernel * options.kernel;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  std::vector<double> squared(k);
  for (int round = 0; round < 20; ++round) {
    double sum = 0.0;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < k; ++i) {
      sum += plane.weights[i];
      centre += plane.weights[i] * means[i];
    }
    centre /= sum;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < k; ++i) {
      const Eigen::Vector3d off = means[i] - centre;
      scatter += plane.weights[i] * (covariances[i] + off * off.transpose());
    }
    solver.computeDirect(scatter);
    plane.normal = solver.eigenvectors().col(0);
    plane.centre = centre + origin;
    plane.cost = 0.0;
    double change = 0.0;
    for (std::size_t i = 0; i < k; ++i) {
      const double off = plane.normal.dot(means[i] - centre);
      squared[i] = information[i] * (off * off + plane.normal.dot(covariances[i] * plane.normal));
      const double weight = information[i] / (1.0 + squared[i] / scale);
      change = std::max(change, std::abs(weight - plane.weights[i]) / information[i]);
      plane.weights[i] = weight;
      plane.cost += 0.5 * scale * std::log1p(squared[i] / scale);
    }
    if (change < 1e-8) break;
  }
  return plane;
}

SurfaceTerm linearise(const Surface& surface, const std::vector<Pose>& T_world_submap,
                      const SurfaceAdjustmentOptions& options) {
  const WeightedPlane plane = weighted_plane(surface, T_world_submap, options);
  const Eigen::Matrix<double, 3, 2> B = basis_across(plane.normal);
  SurfaceTerm term;
  term.cost = plane.cost;
  Eigen::Matrix3d plane_information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d plane_gradient = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < surface.parts.size(); ++i) {
    const SurfacePart& part = surface.parts[i];
    const Pose& T = T_world_submap[part.submap];
    const Eigen::Matrix3d Rt = T.rotation_matrix().transpose();
    // About the surface's centre, so that turning the plane is no matter of the world's origin.
    const Eigen::Vector3d t = T.translation - plane.centre;
    const Eigen::Vector3d n = Rt * plane.normal;
    Eigen::Vector4d in_submap;
    in_submap << n, plane.normal.dot(t);
    const Eigen::Matrix4d root = std::sqrt(plane.weights[i]) * root_of_moments(part).transpose();
    const Eigen::Vector4d r = root * in_submap;
    Matrix46d J = Matrix46d::Zero();
    J.topRightCorner<3, 3>() = skew(n);
    J.bottomLeftCorner<1, 3>() = n.transpose();
    Matrix43d Jp = Matrix43d::Zero();
    Jp.topLeftCorner<3, 2>() = Rt * B;
    Jp.bottomLeftCorner<1, 2>() = t.transpose() * B;
    Jp(3, 2) = 1.0;
    const Matrix46d A = root * J;
    const Matrix43d Ap = root * Jp;
    term.own.emplace_back(A.transpose() * A);
    term.cross.emplace_back(A.transpose() * Ap);
    term.gradient.emplace_back(A.transpose() * r);
    plane_information += Ap.transpose() * Ap;
    plane_gradient += Ap.transpose() * r;
  }
  term.plane_inverse = plane_information.ldlt().solve(Eigen::Matrix3d::Identity());
  const Eigen::Vector3d shift = term.plane_inverse * plane_gradient;
  for (std::size_t i = 0; i < surface.parts.size(); ++i) term.gradient[i] -= term.cross[i] * shift;
  return term;
}

// A symmetric matrix of 6x6 blocks, the lower triangle.
class BlockMatrix {
 public:
  void add(int row, int column, const Matrix6d& block) {
    if (row < column) {
      add(column, row, block.transpose());
      return;
    }
    const auto [it, fresh] = blocks_.try_emplace({row, column}, block);
    if (!fresh) it->second += block;
  }
  [[nodiscard]] const std::map<std::pair<int, int>, Matrix6d>& blocks() const { return blocks_; }

 private:
  std::map<std::pair<int, int>, Matrix6d> blocks_;
};

struct Equations {
  BlockMatrix information;
  std::vector<Vector6d> gradient;
  double cost = 0.0;
};

constexpr std::size_t kBlock = 256;

void add_surfaces(const std::vector<Surface>& surfaces, const std::vector<Pose>& poses,
                  const SurfaceAdjustmentOptions& options, Equations& equations) {
  std::vector<SurfaceTerm> terms(std::min<std::size_t>(surfaces.size(), 16 * kBlock));
  for (std::size_t begin = 0; begin < surfaces.size(); begin += terms.size()) {
    const std::size_t count = std::min(terms.size(), surfaces.size() - begin);
    parallel_for(count, kBlock,
                 [&](std::size_t i) { terms[i] = linearise(surfaces[begin + i], poses, options); });
    for (std::size_t s = 0; s < count; ++s) {
      const SurfaceTerm& term = terms[s];
      const std::vector<SurfacePart>& parts = surfaces[begin + s].parts;
      equations.cost += term.cost;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        equations.gradient[parts[i].submap] += term.gradient[i];
        const Matrix63d scaled = term.cross[i] * term.plane_inverse;
        for (std::size_t j = 0; j <= i; ++j) {
          Matrix6d block = -scaled * term.cross[j].transpose();
          if (i == j) block += term.own[i];
          equations.information.add(parts[i].submap, parts[j].submap, block);
        }
      }
    }
  }
}

Vector6d prior_residual(const RelativePrior& prior, const std::vector<Pose>& poses) {
  return log_se3(prior.T_from_to.inverse() * (poses[prior.from].inverse() * poses[prior.to]));
}

double add_priors(const std::vector<RelativePrior>& priors, const std::vector<Pose>& poses,
                  Equations& equations) {
  double cost = 0.0;
  for (const RelativePrior& prior : priors) {
    const Vector6d r = prior_residual(prior, poses);
    const Matrix6d J_to = right_jacobian_inverse_se3(r);
    const Pose T_to_from = poses[prior.to].inverse() * poses[prior.from];
    const Matrix6d J_from = -J_to * adjoint(T_to_from);
    const Vector6d weighted = prior.information * r;
    equations.gradient[prior.to] += J_to.transpose() * weighted;
    equations.gradient[prior.from] += J_from.transpose() * weighted;
    equations.information.add(prior.to, prior.to, J_to.transpose() * prior.information * J_to);
    equations.information.add(prior.from, prior.from,
                              J_from.transpose() * prior.information * J_from);
    equations.information.add(prior.to, prior.from, J_to.transpose() * prior.information * J_from);
    cost += 0.5 * r.dot(weighted);
  }
  equations.cost += cost;
  return cost;
}

double prior_cost(const std::vector<RelativePrior>& priors, const std::vector<Pose>& poses) {
  double cost = 0.0;
  for (const RelativePrior& prior : priors) {
    const Vector6d r = prior_residual(prior, poses);
    cost += 0.5 * r.dot(prior.information * r);
  }
  return cost;
}

double cost_of(const std::vector<Surface>& surfaces, const std::vector<RelativePrior>& priors,
               const std::vector<Pose>& poses, const SurfaceAdjustmentOptions& options) {
  return prior_cost(priors, poses) +
         ordered_sum(surfaces.size(), kBlock, 0.0, [&](std::size_t begin, std::size_t end) {
           double sum = 0.0;
           for (std::size_t i = begin; i < end; ++i)
             sum += weighted_plane(surfaces[i], poses, options).cost;
           return sum;
         });
}

// The step of all submaps but the fixed one, damped on the diagonal. Empty where the matrix is
// singular.
std::vector<Vector6d> solve(const Equations& equations, int fixed, double damping) {
  const auto n = static_cast<int>(equations.gradient.size());
  const auto row_of = [&](int submap) { return 6 * (submap > fixed ? submap - 1 : submap); };
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [place, block] : equations.information.blocks()) {
    if (place.first == fixed || place.second == fixed) continue;
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < (place.first == place.second ? r + 1 : 6); ++c) {
        double value = block(r, c);
        if (place.first == place.second && r == c) value += damping * value + 1e-9;
        triplets.emplace_back(row_of(place.first) + r, row_of(place.second) + c, value);
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(6 * (n - 1), 6 * (n - 1));
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::VectorXd gradient(6 * (n - 1));
  for (int i = 0; i < n; ++i) {
    if (i != fixed) gradient.segment<6>(row_of(i)) = equations.gradient[i];
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(matrix);
  if (solver.info() != Eigen::Success) return {};
  const Eigen::VectorXd step = -solver.solve(gradient);
  if (!step.allFinite()) return {};
  std::vector<Vector6d> steps(n, Vector6d::Zero());
  for (int i = 0; i < n; ++i) {
    if (i != fixed) steps[i] = step.segment<6>(row_of(i));
  }
  return steps;
}

void check_names(const std::vector<Surface>& surfaces, const std::vector<RelativePrior>& priors,
                 std::size_t submaps) {
  const auto exists = [&](int s) { return s >= 0 && s < static_cast<int>(submaps); };
  for (const Surface& surface : surfaces) {
    for (const SurfacePart& part : surface.parts)
      check(exists(part.submap), "a surface's submap exists");
  }
  for (const RelativePrior& prior : priors)
    check(exists(prior.from) && exists(prior.to), "a prior's submaps exist");
}

}  // namespace

SurfaceAdjustment adjust_surfaces(const std::vector<Surface>& surfaces,
                                  const std::vector<RelativePrior>& priors,
                                  std::vector<Pose> T_world_submap, int fixed,
                                  const SurfaceAdjustmentOptions& options) {
  validate(options, "surface_adjustment");
  check_names(surfaces, priors, T_world_submap.size());
  SurfaceAdjustment result;
  std::vector<Pose>& poses = T_world_submap;
  double cost = result.cost_before = cost_of(surfaces, priors, poses, options);
  result.prior_before = prior_cost(priors, poses);
  double damping = 1e-6;
  while (result.iterations < options.max_iterations && poses.size() > 1 && !result.converged) {
    ++result.iterations;
    Equations equations;
    equations.gradient.assign(poses.size(), Vector6d::Zero());
    add_surfaces(surfaces, poses, options, equations);
    add_priors(priors, poses, equations);
    for (int trial = 0; trial < 8; ++trial, damping *= 10.0) {
      const std::vector<Vector6d> steps = solve(equations, fixed, damping);
      if (steps.empty()) continue;
      std::vector<Pose> moved = poses;
      double metres = 0.0;
      double radians = 0.0;
      for (std::size_t i = 0; i < poses.size(); ++i) {
        moved[i] = poses[i] * exp_se3(steps[i]);
        metres = std::max(metres, steps[i].head<3>().norm());
        radians = std::max(radians, steps[i].tail<3>().norm());
      }
      const bool small = metres < options.convergence_m && radians < options.convergence_rad;
      const double next = cost_of(surfaces, priors, moved, options);
      if (next > cost) {
        result.converged = result.converged || small;
        if (small) break;
        continue;
      }
      result.converged = small;
      cost = next;
      poses = std::move(moved);
      damping = std::max(1e-9, damping / 100.0);
      break;
    }
    if (damping > 1e3) break;
  }
  result.cost_after = cost;
  result.prior_after = prior_cost(priors, poses);
  for (const RelativePrior& prior : priors) {
    const Vector6d r = prior_residual(prior, poses);
    result.worst_prior = std::max(result.worst_prior, r.dot(prior.information * r));
  }
  result.T_world_submap = std::move(poses);
  return result;
}

SurfaceNormalEquations surface_normal_equations(const std::vector<Surface>& surfaces,
                                                const std::vector<Pose>& T_world_submap,
                                                const SurfaceAdjustmentOptions& options) {
  Equations equations;
  equations.gradient.assign(T_world_submap.size(), Vector6d::Zero());
  add_surfaces(surfaces, T_world_submap, options, equations);
  SurfaceNormalEquations result;
  const auto n = static_cast<Eigen::Index>(6 * T_world_submap.size());
  result.information = Eigen::MatrixXd::Zero(n, n);
  result.gradient = Eigen::VectorXd::Zero(n);
  for (const auto& [place, block] : equations.information.blocks()) {
    result.information.block<6, 6>(6 * place.first, 6 * place.second) = block;
    result.information.block<6, 6>(6 * place.second, 6 * place.first) = block.transpose();
  }
  for (std::size_t i = 0; i < T_world_submap.size(); ++i)
    result.gradient.segment<6>(static_cast<Eigen::Index>(6 * i)) = equations.gradient[i];
  result.cost = equations.cost;
  return result;
}

SurfaceThickness thickness_of(const std::vector<Surface>& surfaces,
                              const std::vector<Pose>& T_world_submap) {
  SurfaceThickness result;
  std::vector<double> all;
  for (const Surface& surface : surfaces)
    all.push_back(fit_surface(surface.parts, T_world_submap).thickness());
  result.surfaces = all.size();
  if (all.empty()) return result;
  for (const double t : all) result.mean += t / static_cast<double>(all.size());
  const std::size_t at = all.size() * 95 / 100;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(at), all.end());
  result.most = all[at];
  return result;
}

}  // namespace groundloop
