#include "backend/session/session_graph.hpp"

#include <algorithm>
#include <string>

#include "backend/graph/g2o_file.hpp"
#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what + "; make the session again");
}

}  // namespace

void write_session_graph(const std::filesystem::path& file, const PoseGraph& graph) {
  PoseGraph written = graph;
  std::erase_if(written.edges, [](const GraphEdge& edge) { return edge.rejected; });
  std::stable_partition(written.edges.begin(), written.edges.end(),
                        [](const GraphEdge& edge) { return edge.kind == EdgeKind::odometry; });
  write_g2o(file, written);
}

PoseGraph read_session_graph(const std::filesystem::path& file, std::size_t maps,
                             const std::vector<ClosureEnds>& accepted) {
  PoseGraph graph = read_g2o(file).graph;
  if (graph.vertices.size() != maps) fail(file, "vertices and local maps differ in number");
  for (std::size_t v = 0; v < maps; ++v) {
    if (graph.vertices[v].id != static_cast<int>(v))
      fail(file, "vertices are not numbered as local maps");
  }
  if (graph.edges.size() < accepted.size())
    fail(file, "has fewer edges than closures.csv has accepted closures");
  const std::size_t odometry = graph.edges.size() - accepted.size();
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    GraphEdge& edge = graph.edges[k];
    edge.kind = k < odometry ? EdgeKind::odometry : EdgeKind::closure;
    if (k < odometry) continue;
    const ClosureEnds& ends = accepted[k - odometry];
    if (edge.from != ends.query || edge.to != ends.reference)
      fail(file, "edge " + std::to_string(k + 1) + " is not that of the closure in its place");
  }
  return graph;
}

}  // namespace groundloop
