#include "backend/mapping/scan_uncertainty.hpp"

#include <vector>

#include "backend/graph/relative_pose.hpp"

namespace groundloop {
namespace {

// Adds the scans of a recording, and the steps between them.
class Chain {
 public:
  Chain(const SessionPart& part, const OdometryInformationOptions& drift, PoseGraph& graph)
      : drift_(drift), graph_(graph), first_(static_cast<int>(graph.vertices.size())) {
    for (const StampedPose& sample : part.trajectory) {
      T_world_scan_.push_back(sample.pose);
      const auto vertex = static_cast<int>(graph.vertices.size());
      graph.vertices.push_back({vertex, sample.pose, false});
    }
  }

  // How much more the way from one scan to another errs than the drift model says, as a factor on
  // variances: by headings, which no lever acts on.
  [[nodiscard]] double factor(std::size_t from, std::size_t to, const Matrix6d& information) const {
    const Matrix6d stated = compose_odometry(T_world_scan_, from, to, drift_).covariance;
    return covariance_of(information).bottomRightCorner<3, 3>().trace() /
           stated.bottomRightCorner<3, 3>().trace();
  }

  void add_steps(std::size_t from, std::size_t to, double factor) {
    for (std::size_t i = from + 1; i <= to; ++i) {
      GraphEdge edge;
      edge.from = first_ + static_cast<int>(i) - 1;
      edge.to = edge.from + 1;
      edge.T_from_to = T_world_scan_[i - 1].inverse() * T_world_scan_[i];
      edge.information = odometry_information(edge.T_from_to, drift_) / factor;
      graph_.edges.push_back(edge);
    }
  }

  [[nodiscard]] std::size_t scans() const { return T_world_scan_.size(); }

 private:
  const OdometryInformationOptions& drift_;
  PoseGraph& graph_;
  int first_;
  std::vector<Pose> T_world_scan_;
};

}  // namespace

PoseGraph graph_of_scans(const StoredSession& session, const OdometryInformationOptions& drift) {
  PoseGraph graph;
  std::vector<int> scan_of;  // vertex of each map's first scan
  std::vector<const Matrix6d*> way_to(session.graph.vertices.size(), nullptr);
  for (const GraphEdge& edge : session.graph.edges) {
    if (edge.kind == EdgeKind::odometry) way_to[edge.to] = &edge.information;
  }
  for (const SessionPart& part : session.parts) {
    const auto first = static_cast<int>(graph.vertices.size());
    Chain chain(part, drift, graph);
    double factor = 1.0;  // the last map errs as the one before
    for (std::size_t m = 0; m < part.maps.size(); ++m) {
      const LocalMapRecord& map = part.maps[m];
      scan_of.push_back(first + static_cast<int>(map.first_scan));
      const bool last = m + 1 == part.maps.size();
      const std::size_t end = last ? chain.scans() - 1 : part.maps[m + 1].first_scan;
      const Matrix6d* way =
          last ? nullptr : way_to[static_cast<std::size_t>(part.first_map) + m + 1];
      if (way != nullptr) factor = chain.factor(map.first_scan, end, *way);
      chain.add_steps(map.first_scan, end, factor);
    }
  }
  for (std::size_t v = 0; v < scan_of.size(); ++v)
    graph.vertices[scan_of[v]].fixed = session.graph.vertices[v].fixed;
  for (GraphEdge edge : session.graph.edges) {
    if (edge.kind == EdgeKind::odometry) continue;
    edge.from = scan_of[edge.from];
    edge.to = scan_of[edge.to];
    edge.T_from_to = graph.vertices[edge.from].pose.inverse() * graph.vertices[edge.to].pose;
    graph.edges.push_back(edge);
  }
  return graph;
}

}  // namespace groundloop
