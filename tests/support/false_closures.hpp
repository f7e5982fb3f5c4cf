// False closures to plant in a pose graph of known poses: random ones, groups that agree with each
// other, and ones at true places but 5 to 20 m off.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "backend/graph/pose_graph.hpp"

namespace groundloop::testing {

class FalseClosures {
 public:
  /// `poses` are those that closures of the graph should agree with; all false ones get
  /// `information`.
  FalseClosures(const std::vector<Pose>& poses, const Matrix6d& information, std::uint64_t seed)
      : poses_(poses), information_(information), generator_(seed) {}

  /// `count` closures between random vertices at least `apart` ids from each other, up to 10 m and
  /// 100 degrees.
  void add_random(PoseGraph& graph, int count, int apart) {
    for (int k = 0; k < count; ++k) {
      const auto [from, to] = pair(apart, 0);
      graph.edges.push_back(closure(from, to, random_pose()));
    }
  }

  /// Groups of `size` closures between two stretches of the way, `spacing` ids from one to the
  /// next, that agree with each other to centimetres: one place taken for another.
  void add_groups(PoseGraph& graph, int groups, int size, int spacing, int apart) {
    for (int g = 0; g < groups; ++g) {
      const auto [from, to] = pair(apart, size * spacing);
      add_group(graph, from, to, random_pose(), size, spacing);
    }
  }

  /// Groups at places visited twice (`lap` ids apart), 5 to 20 m from the truth; size 1 for single
  /// ones.
  void add_near(PoseGraph& graph, int groups, int size, int spacing, int lap) {
    for (int g = 0; g < groups; ++g) {
      const int from = lap + index(count() - lap - size * spacing);
      const int to = from - lap;
      add_group(graph, from, to, poses_[from].inverse() * poses_[to] * offset(), size, spacing);
    }
  }

 private:
  [[nodiscard]] int count() const { return static_cast<int>(poses_.size()); }
  int index(int below) {
    return static_cast<int>(generator_() % static_cast<std::uint64_t>(below));
  }
  double uniform(double size) {
    return std::uniform_real_distribution<double>(-size, size)(generator_);
  }
  std::pair<int, int> pair(int apart, int margin) {
    for (;;) {
      const int from = index(count() - margin);
      const int to = index(count() - margin);
      if (std::abs(from - to) >= apart) return {from, to};
    }
  }
  Pose random_pose(double metres = 10.0, double radians = 1.75) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = uniform(i < 3 ? metres : radians);
    return exp_se3(xi);
  }
  Pose offset() {
    const double direction = uniform(M_PI);
    const double distance = 12.5 + uniform(7.5);
    Vector6d xi;
    xi << distance * std::cos(direction), distance * std::sin(direction), uniform(0.5), 0, 0,
        uniform(0.05);
    return exp_se3(xi);
  }
  void add_group(PoseGraph& graph, int from, int to, const Pose& Z, int size, int spacing) {
    for (int i = 0; i < size * spacing; i += spacing) {
      const Pose back = poses_[from + i].inverse() * poses_[from];
      const Pose on = poses_[to].inverse() * poses_[to + i];
      graph.edges.push_back(closure(from + i, to + i, back * Z * on * random_pose(0.05, 0.003)));
    }
  }
  GraphEdge closure(int from, int to, const Pose& T_from_to) const {
    GraphEdge edge;
    edge.from = from;
    edge.to = to;
    edge.T_from_to = T_from_to;
    edge.information = information_;
    edge.kind = EdgeKind::closure;
    return edge;
  }

  const std::vector<Pose>& poses_;
  Matrix6d information_;
  std::mt19937_64 generator_;
};

/// How verdicts stand against the truth; false closures are those from edge `first_false` on.
struct Verdicts {
  int false_rejected = 0, false_kept = 0, true_rejected = 0, true_kept = 0;
  /// Of the verdict "rejected".
  [[nodiscard]] double precision() const {
    const int rejected = false_rejected + true_rejected;
    return rejected == 0 ? 1.0 : static_cast<double>(false_rejected) / rejected;
  }
  [[nodiscard]] double recall() const {
    const int all = false_rejected + false_kept;
    return all == 0 ? 1.0 : static_cast<double>(false_rejected) / all;
  }
};

inline Verdicts count_verdicts(const PoseGraph& graph, std::size_t first_false) {
  Verdicts v;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    if (graph.edges[k].kind != EdgeKind::closure) continue;
    const bool rejected = graph.edges[k].rejected;
    ++(k >= first_false ? (rejected ? v.false_rejected : v.false_kept)
                        : (rejected ? v.true_rejected : v.true_kept));
  }
  return v;
}

}  // namespace groundloop::testing
