#include "backend/graph/factors.hpp"

#include "backend/graph/vertical_factor.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kBlock = 1024;

}  // namespace

double cost(const PoseGraph& graph) {
  double sum = 0.0;
  for_each_kind(graph, [&](const auto& factors) {
    sum += ordered_sum(factors.size(), kBlock, 0.0, [&](std::size_t begin, std::size_t end) {
      double part = 0.0;
      for (std::size_t k = begin; k < end; ++k) {
        if (counts(factors[k])) part += cost(graph, factors[k]);
      }
      return part;
    });
  });
  return sum;
}

void perturb(PoseGraph& graph, int variable, const Vector6d& step) {
  const auto poses = static_cast<int>(graph.vertices.size());
  const auto ups = static_cast<int>(graph.ups.size());
  if (variable < poses) {
    Pose& pose = graph.vertices[variable].pose;
    pose = pose * exp_se3(step);
  } else if (variable < poses + ups) {
    Eigen::Vector3d& up = graph.ups[variable - poses];
    up = (up + across(up) * step.head<2>()).normalized();
  } else {
    graph.bends[variable - poses - ups] += step.head<2>();
  }
}

}  // namespace groundloop
