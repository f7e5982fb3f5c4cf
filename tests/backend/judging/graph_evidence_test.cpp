#include "backend/judging/graph_evidence.hpp"

#include <gtest/gtest.h>

#include "backend/graph/relative_pose.hpp"
#include "backend/judging/closure_groups.hpp"

namespace groundloop {
namespace {

// Two poses measured twice, a millimetre apart: flat as far as six digits go.
PoseGraph measured_twice(const Matrix6d& first, const Matrix6d& second) {
  PoseGraph graph;
  graph.vertices = {{0, Pose(), true}, {1, Pose(), false}};
  GraphEdge edge;
  edge.from = 0;
  edge.to = 1;
  edge.information = first;
  graph.edges.push_back(edge);
  edge.information = second;
  edge.kind = EdgeKind::closure;
  edge.T_from_to.translation.x() = 0.001;
  graph.edges.push_back(edge);
  return graph;
}

// The two differ as normal variables do whose covariances add.
double closed_form(const PoseGraph& graph) {
  RelativePose between;
  between.T_from_to = graph.edges[1].T_from_to;
  between.covariance = covariance_of(graph.edges[0].information) +
                       bounded_information(graph.edges[1].information).inverse();
  return log_density(between);
}

TEST(GraphEvidence, IsTheDensityOfTheDifferenceOfTwoMeasurements) {
  const PoseGraph graph =
      measured_twice(400.0 * Matrix6d::Identity(), 100.0 * Matrix6d::Identity());
  EXPECT_NEAR(log_marginal_density(graph), closed_form(graph), 1e-6);
}

TEST(GraphEvidence, ADirectionThatNobodyMeasuredIsUnknownNotCertain) {
  Matrix6d open = 400.0 * Matrix6d::Identity();
  open(0, 0) = 0.0;
  const PoseGraph graph = measured_twice(open, 100.0 * Matrix6d::Identity());
  EXPECT_NEAR(log_marginal_density(graph), closed_form(graph), 1e-6);
  // What the second says along it is no surprise: less dense than where both measured.
  EXPECT_LT(log_marginal_density(graph),
            log_marginal_density(
                measured_twice(400.0 * Matrix6d::Identity(), 100.0 * Matrix6d::Identity())));
}

}  // namespace
}  // namespace groundloop
