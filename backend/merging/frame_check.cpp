#include "backend/merging/frame_check.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

namespace groundloop {
namespace {

// Parts of one frame that hang together, and whether they are what the input had.
struct Group {
  std::vector<int> parts;
  bool as_before = true;
};

// By frame and component, so in a fixed order.
std::map<std::pair<int, int>, Group> groups_of(const JointProblem& problem,
                                               const std::vector<int>& frames_before) {
  const std::vector<int> component = connected_components(problem.graph);
  std::map<std::pair<int, int>, Group> groups;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    const MergedPart& part = problem.parts[p];
    Group& group = groups[{part.frame, component[part.first_map]}];
    group.parts.push_back(static_cast<int>(p));
    if (frames_before[p] != frames_before[group.parts.front()]) group.as_before = false;
  }
  return groups;
}

void restore(JointProblem& problem, int p, int frame, const PoseGraph& before) {
  MergedPart& part = problem.parts[p];
  part.frame = frame;
  part.odometry_scale = 1.0;
  const auto first = static_cast<std::size_t>(part.first_map);
  for (std::size_t m = 0; m < part.maps.size(); ++m)
    problem.graph.vertices[first + m].pose = before.vertices[first + m].pose;
  for (std::size_t k = 0; k < before.edges.size(); ++k) {
    if (problem.part_of[before.edges[k].from] == p)
      problem.graph.edges[k].information = before.edges[k].information;
  }
}

// Into the world of the first of them, whose first map is where its odometry has it.
void move_to_own_world(JointProblem& problem, const Group& group) {
  const MergedPart& root = problem.parts[group.parts.front()];
  const Pose move = root.odometry[root.maps.front().first_scan].pose *
                    problem.graph.vertices[root.first_map].pose.inverse();
  for (const int p : group.parts) {
    MergedPart& part = problem.parts[p];
    part.frame = group.parts.front();
    for (std::size_t m = 0; m < part.maps.size(); ++m) {
      Pose& pose = problem.graph.vertices[static_cast<std::size_t>(part.first_map) + m].pose;
      pose = move * pose;
    }
  }
}

std::string names(const JointProblem& problem, const Group& group) {
  std::string text;
  for (const int p : group.parts)
    text += (text.empty() ? "'" : " with '") + problem.parts[p].source->name + "'";
  return text;
}

}  // namespace

void check_frames(JointProblem& problem, const std::vector<int>& frames_before,
                  const PoseGraph& before) {
  const auto groups = groups_of(problem, frames_before);
  for (const auto& [key, group] : groups) {
    const int frame = key.first;
    const bool whole = std::count_if(groups.begin(), groups.end(), [&](const auto& other) {
                         return other.first.first == frame;
                       }) == 1;
    if (whole) continue;
    const bool root = std::find(group.parts.begin(), group.parts.end(), frame) != group.parts.end();
    if (!root) {
      problem.notes.push_back(names(problem, group) + " not connected to '" +
                              problem.parts[frame].source->name +
                              "': the joint solution contradicts the closures between them");
      spdlog::warn("{}", problem.notes.back());
    }
    if (group.as_before) {
      for (const int p : group.parts) restore(problem, p, frames_before[p], before);
    } else if (!root) {
      move_to_own_world(problem, group);
    }
  }
}

}  // namespace groundloop
