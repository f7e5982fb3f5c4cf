#include "backend/graph/pose_graph.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

PoseGraph two_poses() {
  PoseGraph graph;
  graph.vertices = {{4, Pose(), false}, {9, Pose(), false}};
  GraphEdge edge;
  edge.from = 0;
  edge.to = 1;
  graph.edges = {edge};
  return graph;
}

std::string message_of(const PoseGraph& graph) {
  try {
    check_graph(graph);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(CheckGraph, NamesWhatIsWrong) {
  EXPECT_EQ(message_of(two_poses()), "");
  PoseGraph graph = two_poses();
  graph.edges[0].to = 7;
  EXPECT_NE(message_of(graph).find("edge 0 (4 to none) leaves the graph"), std::string::npos);
  graph = two_poses();
  graph.edges[0].to = 0;
  EXPECT_NE(message_of(graph).find("itself"), std::string::npos);
  graph = two_poses();
  graph.edges[0].information(2, 2) = -1.0;
  EXPECT_NE(message_of(graph).find("edge 0 (4 to 9) has information that is not positive"),
            std::string::npos);
  graph = two_poses();
  graph.edges[0].information(0, 1) = 0.5;
  EXPECT_NE(message_of(graph).find("not symmetric"), std::string::npos);
  graph = two_poses();
  graph.vertices[1].pose.translation.x() = NAN;
  EXPECT_NE(message_of(graph).find("vertex 9 is not finite"), std::string::npos);
}

TEST(ConnectedComponents, AreNumberedByFirstVertexAndIgnoreRejectedEdges) {
  PoseGraph graph;
  for (int i = 0; i < 5; ++i) graph.vertices.push_back({i, Pose(), false});
  for (const auto& [a, b] : {std::pair(3, 1), std::pair(0, 4), std::pair(1, 0)}) {
    GraphEdge edge;
    edge.from = a;
    edge.to = b;
    graph.edges.push_back(edge);
  }
  EXPECT_EQ(connected_components(graph), (std::vector<int>{0, 0, 1, 0, 0}));
  graph.edges[2].rejected = true;
  EXPECT_EQ(connected_components(graph), (std::vector<int>{0, 1, 2, 1, 0}));
}

}  // namespace
}  // namespace groundloop
