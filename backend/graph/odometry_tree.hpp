// What odometry alone says of a pose graph: a spanning forest of its odometry edges, with the pose
// of every vertex in its tree, and the relative pose of any two with its covariance (first order).
// False closures have no part in it.
#pragma once

#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "backend/graph/relative_pose.hpp"

namespace groundloop {

class OdometryTree {
 public:
  /// Trees start at the fixed vertices, and in parts that have none at the first vertex; these keep
  /// their poses. Repeated odometry edges: the first counts. What singular information leaves
  /// open is unknown (covariance_of).
  explicit OdometryTree(const PoseGraph& graph);

  /// T_world_vertex by odometry.
  [[nodiscard]] const Pose& pose(int vertex) const { return nodes_[vertex].T_world_vertex; }
  /// Pose of `to` in `from`; vertices of different trees come with a covariance without meaning
  /// (1e12), so that nothing is concluded from them.
  [[nodiscard]] RelativePose between(int from, int to) const;

 private:
  struct Node {
    Pose T_world_vertex;
    Matrix6d covariance = Matrix6d::Zero();  // from the root on, perturbed in the world frame
    int parent = -1;
    int root = -1;
    int enter = 0;  // position in preorder
    int size = 1;   // vertices below, itself included
  };
  [[nodiscard]] bool is_above(int a, int b) const;

  std::vector<Node> nodes_;
};

}  // namespace groundloop
