// Finished sessions, read back.
#include <pybind11/stl.h>

#include "apps/python/arrays.hpp"
#include "backend/session/stored_session.hpp"
#include "frontend/core/pcd.hpp"

namespace groundloop::python {
namespace {

py::dict closure_row_of(const ClosureRecord& c) {
  using namespace py::literals;
  return py::dict("reference_session"_a = c.reference_session, "reference_map"_a = c.reference_map,
                  "query_session"_a = c.query_session, "query_map"_a = c.query_map,
                  "source"_a = to_string(c.source), "matches"_a = c.matches,
                  "inliers"_a = c.inliers, "status"_a = to_string(c.status),
                  "overlap"_a = c.overlap, "rmse"_a = c.rmse,
                  "pose"_a = array_from(c.T_query_reference));
}

void bind_part(py::module_& module) {
  py::class_<SessionPart>(module, "SessionPart", "One recording of a session.")
      .def_readonly("name", &SessionPart::name)
      .def_readonly("recording", &SessionPart::recording)
      .def_readonly("sensor", &SessionPart::sensor)
      .def_property_readonly(
          "stamps", [](const SessionPart& p) { return stamps_of(p.trajectory); },
          "(N,) int64, nanoseconds")
      .def_property_readonly(
          "poses", [](const SessionPart& p) { return poses_of(p.trajectory); },
          "(N, 4, 4), T_world_scan, optimised")
      .def_property_readonly(
          "odometry", [](const SessionPart& p) { return poses_of(p.odometry); },
          "(N, 4, 4), before closing loops")
      .def_property_readonly(
          "map_poses",
          [](const SessionPart& p) {
            Trajectory poses;
            for (const LocalMapRecord& m : p.maps) poses.push_back({0, m.T_world_map});
            return poses_of(poses);
          },
          "(M, 4, 4), T_world_map, optimised")
      .def_property_readonly(
          "map_scans",
          [](const SessionPart& p) {
            py::array_t<std::int64_t> scans(
                {static_cast<py::ssize_t>(p.maps.size()), py::ssize_t{2}});
            auto a = scans.mutable_unchecked<2>();
            for (std::size_t i = 0; i < p.maps.size(); ++i) {
              a(static_cast<py::ssize_t>(i), 0) = static_cast<std::int64_t>(p.maps[i].first_scan);
              a(static_cast<py::ssize_t>(i), 1) = static_cast<std::int64_t>(p.maps[i].last_scan);
            }
            return scans;
          },
          "(M, 2), first and last scan, both included");
}

}  // namespace

void bind_sessions(py::module_& module) {
  bind_part(module);
  py::class_<StoredSession>(module, "Session", "What `groundloop run` or `merge` left.")
      .def_readonly("parts", &StoredSession::parts, "one a recording")
      .def_property_readonly(
          "closures",
          [](const StoredSession& s) {
            py::list rows;
            for (const ClosureRecord& c : s.closures) rows.append(closure_row_of(c));
            return rows;
          },
          "every candidate as a dict, with the columns of closures.csv; pose is T_query_reference")
      .def(
          "map_points",
          [](const StoredSession& s, std::size_t map, std::size_t part) {
            if (part >= s.parts.size() || map >= s.parts[part].maps.size())
              throw py::index_error("map " + std::to_string(map) + " of part " +
                                    std::to_string(part));
            const int id = s.parts[part].first_map + static_cast<int>(map);
            Points points;
            {
              const py::gil_scoped_release unlocked;
              points = read_pcd(s.folder.local_map(id));
            }
            return array_from(points);
          },
          py::arg("map"), py::arg("part") = 0, "(N, 3) of a local map, in its own frame");
  module.def(
      "load_session",
      [](const std::string& folder) {
        const py::gil_scoped_release unlocked;
        return load_session(folder, LoopClosureOptions());
      },
      py::arg("folder"),
      "Reads a finished session and checks it against its checksums; InputError where it is "
      "unfinished, damaged, or of another version.");
}

}  // namespace groundloop::python
