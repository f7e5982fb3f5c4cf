#include "backend/graph/gauge.hpp"

#include <utility>

namespace groundloop {

std::vector<char> gauge(const PoseGraph& graph, const std::vector<int>& component) {
  std::vector<char> fixed(graph.vertices.size());
  std::vector<char> anchored(graph.vertices.size(), 0);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    fixed[i] = graph.vertices[i].fixed;
    if (fixed[i]) anchored[component[i]] = 1;
  }
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (!std::exchange(anchored[component[i]], 1)) fixed[i] = 1;
  }
  return fixed;
}

}  // namespace groundloop
