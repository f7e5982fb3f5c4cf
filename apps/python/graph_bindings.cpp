// Pose graphs: built, read, solved.
#include <unordered_map>

#include <pybind11/stl.h>

#include "apps/python/arrays.hpp"
#include "backend/graph/g2o_file.hpp"
#include "backend/judging/optimizer.hpp"

namespace groundloop::python {
namespace {

// A graph whose vertices are called by their ids.
class NamedGraph {
 public:
  NamedGraph() = default;
  explicit NamedGraph(PoseGraph graph) : graph_(std::move(graph)) {
    for (std::size_t i = 0; i < graph_.vertices.size(); ++i)
      places_[graph_.vertices[i].id] = static_cast<int>(i);
  }

  void add_vertex(int id, const NumberArray& pose, bool fixed) {
    if (!places_.emplace(id, static_cast<int>(graph_.vertices.size())).second)
      throw InputError("vertex " + std::to_string(id) + " is in the graph already");
    graph_.vertices.push_back({id, pose_from(pose), fixed});
  }
  void add_edge(int from, int to, const NumberArray& pose, const NumberArray& information,
                bool closure) {
    GraphEdge edge;
    edge.from = place(from);
    edge.to = place(to);
    edge.T_from_to = pose_from(pose);
    edge.information = matrix_from(information);
    edge.kind = closure ? EdgeKind::closure : EdgeKind::odometry;
    if (const std::string defect = defect_of(edge); !defect.empty())
      throw InputError("edge " + std::to_string(from) + " " + std::to_string(to) + ": " + defect);
    graph_.edges.push_back(edge);
  }
  [[nodiscard]] py::array_t<double> pose(int id) const {
    return array_from(graph_.vertices[static_cast<std::size_t>(place(id))].pose);
  }
  [[nodiscard]] std::vector<int> ids() const {
    std::vector<int> ids;
    for (const GraphVertex& v : graph_.vertices) ids.push_back(v.id);
    return ids;
  }
  [[nodiscard]] py::array_t<double> poses() const {
    Trajectory all;
    for (const GraphVertex& v : graph_.vertices) all.push_back({0, v.pose});
    return poses_of(all);
  }
  PoseGraph& graph() { return graph_; }
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }

 private:
  [[nodiscard]] int place(int id) const {
    const auto found = places_.find(id);
    if (found == places_.end())
      throw InputError("there is no vertex " + std::to_string(id) + "; add it before its edges");
    return found->second;
  }

  PoseGraph graph_;
  std::unordered_map<int, int> places_;
};

py::dict summary_of(const OptimizationSummary& s) {
  using namespace py::literals;
  return py::dict("cost_before"_a = s.cost_before, "cost_after"_a = s.cost_after,
                  "iterations"_a = s.iterations, "converged"_a = s.converged,
                  "initialisation"_a = s.initialisation, "termination"_a = s.termination,
                  "components"_a = s.components, "rejected_edges"_a = s.rejected_edges);
}

}  // namespace

void bind_graphs(py::module_& module) {
  py::class_<NamedGraph>(module, "PoseGraph", "Poses and measurements between them.")
      .def(py::init<>())
      .def_static(
          "read", [](const std::string& file) { return NamedGraph(read_g2o(file).graph); },
          py::arg("file"), "From a g2o file; edges between successive ids are odometry.")
      .def(
          "write", [](const NamedGraph& g, const std::string& file) { write_g2o(file, g.graph()); },
          py::arg("file"), "As g2o.")
      .def("add_vertex", &NamedGraph::add_vertex, py::arg("id"), py::arg("pose"),
           py::arg("fixed") = false, "pose: T_world_vertex, 4x4; the first guess")
      .def("add_edge", &NamedGraph::add_edge, py::arg("from_id"), py::arg("to_id"), py::arg("pose"),
           py::arg("information"), py::arg("closure") = false,
           "pose: T_from_to, 4x4; information 6x6 of a perturbation on its right, translation then "
           "rotation. A closure is judged where optimize() is robust.")
      .def("pose", &NamedGraph::pose, py::arg("id"), "T_world_vertex, 4x4")
      .def_property_readonly("ids", &NamedGraph::ids)
      .def_property_readonly("poses", &NamedGraph::poses, "(N, 4, 4), in the order of ids")
      .def("__len__", [](const NamedGraph& g) { return g.graph().vertices.size(); })
      .def(
          "optimize",
          [](NamedGraph& g, const py::object& progress, const py::kwargs& keywords) {
            const auto options = options_from<OptimizerOptions>(keywords, "pose_graph");
            const Progress report = interruptible(progress);
            OptimizationSummary summary;
            {
              const py::gil_scoped_release unlocked;
              summary = optimize(g.graph(), options, report);
            }
            return summary_of(summary);
          },
          py::arg("progress") = py::none(),
          "Solves in place; robust=True judges closures. Returns a dict with costs, iterations and "
          "the edges that were rejected.");
}

}  // namespace groundloop::python
