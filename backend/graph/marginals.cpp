#include "backend/graph/marginals.hpp"

#include "frontend/core/error.hpp"

namespace groundloop {

Marginals::Marginals(const PoseGraph& graph, const std::vector<char>& held)
    : graph_(graph), equations_(graph, held) {
  equations_.assemble(graph);
  if (!equations_.matrix().factorise()) {
    throw InputError(
        "pose graph: its facts leave a pose open, so that nothing is known of its error; leave the "
        "edges without information out");
  }
}

Eigen::MatrixXd Marginals::inverse_block(int i, int j) {
  if (!inverted_) equations_.matrix().invert_pattern();
  inverted_ = true;
  return equations_.matrix().inverse_block(i, j);
}

Matrix6d Marginals::of_pose(int vertex) {
  const int block = equations_.block_of(vertex);
  return block < 0 ? Matrix6d::Zero() : Matrix6d(inverse_block(block, block));
}

std::vector<RelativePose> Marginals::between(int from, std::span<const int> to) {
  const auto column = [&](int vertex) { return equations_.first_row_of(vertex); };
  Eigen::MatrixXd columns;  // of the covariance, those of `from`
  if (column(from) >= 0) {
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(equations_.gradient().size(), 6);
    unit.middleRows<6>(column(from)).setIdentity();
    columns = equations_.matrix().solve(unit);
  }
  const auto joint = [&](int vertex) -> Matrix6d {
    if (column(from) < 0 || column(vertex) < 0) return Matrix6d::Zero();
    return columns.middleRows<6>(column(vertex));
  };
  const Matrix6d own = joint(from);
  std::vector<RelativePose> result;
  result.reserve(to.size());
  for (const int vertex : to) {
    RelativePose pose;
    pose.T_from_to = graph_.vertices[from].pose.inverse() * graph_.vertices[vertex].pose;
    // A movement of `from` is one of `to` in the opposite direction, seen from there.
    const Matrix6d carry = adjoint(pose.T_from_to.inverse());
    const Matrix6d mixed = joint(vertex) * carry.transpose();
    pose.covariance = of_pose(vertex) + carry * own * carry.transpose() - mixed - mixed.transpose();
    pose.covariance = (0.5 * (pose.covariance + pose.covariance.transpose())).eval();
    result.push_back(pose);
  }
  return result;
}

std::optional<std::vector<Matrix6d>> pose_covariances(const PoseGraph& graph) {
  try {
    Marginals marginals(graph, gauge(graph));
    std::vector<Matrix6d> covariances;
    covariances.reserve(graph.vertices.size());
    for (std::size_t v = 0; v < graph.vertices.size(); ++v)
      covariances.push_back(marginals.of_pose(static_cast<int>(v)));
    return covariances;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace groundloop
