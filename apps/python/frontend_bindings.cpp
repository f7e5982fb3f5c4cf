// Recordings, odometry and local maps.
#include <algorithm>
#include <memory>
#include <utility>

#include <pybind11/stl.h>

#include "apps/python/arrays.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/odometry.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::python {
namespace {

py::object times_of(const Scan& scan) {
  if (scan.times.empty()) return py::none();
  return py::array_t<float>(static_cast<py::ssize_t>(scan.times.size()), scan.times.data());
}

std::size_t index_from(py::ssize_t index, std::size_t size) {
  const py::ssize_t n = static_cast<py::ssize_t>(size);
  if (index < -n || index >= n)
    throw py::index_error("scan " + std::to_string(index) + " of " + std::to_string(n));
  return static_cast<std::size_t>(index < 0 ? index + n : index);
}

py::dict info_of(const Recording& recording) {
  const RecordingInfo& info = recording.info();
  using namespace py::literals;
  return py::dict("path"_a = info.path, "format"_a = info.format, "sensor"_a = info.sensor,
                  "point_times"_a = info.point_times, "stamp_source"_a = info.stamp_source,
                  "fields"_a = info.fields, "notes"_a = info.notes, "gaps"_a = info.gaps,
                  "duplicates"_a = info.duplicates, "out_of_order"_a = info.out_of_order,
                  "dropped_scans"_a = info.dropped_scans);
}

Scan scan_from(const PointArray& points, Nanoseconds stamp,
               const std::optional<PointArray>& times) {
  Scan scan;
  scan.stamp = stamp;
  scan.points = points_from(points);
  if (!times) return scan;
  if (times->ndim() != 1 || times->shape(0) != points.shape(0))
    throw InputError("times: expected one a point");
  // Points that are not finite went, and their times go with them.
  const auto p = points.unchecked<2>();
  const auto t = times->unchecked<1>();
  for (py::ssize_t i = 0; i < t.shape(0); ++i) {
    if (Eigen::Vector3f(p(i, 0), p(i, 1), p(i, 2)).allFinite()) scan.times.push_back(t(i));
  }
  return scan;
}

struct OdometryRun {
  Trajectory trajectory;
  std::vector<LocalMap> maps;
  std::size_t predicted = 0;
};

OdometryRun run_odometry(Recording& recording, const OdometryOptions& options,
                         const LocalMapOptions& map_options, const Progress& progress) {
  OdometryRun run;
  Odometry odometry(options);
  LocalMapBuilder builder(map_options);
  const std::size_t n = recording.size();
  for (std::size_t i = 0; i < n; ++i) {
    progress("odometry", i, n);
    const Scan scan = recording.read(i);
    if (i == 0 && n > 1) odometry.start(scan, recording.read(1));
    const RegisteredScan registered = odometry.add(scan, "scan " + std::to_string(i));
    run.trajectory.push_back({scan.stamp, registered.T_world_scan});
    if (auto map = builder.add(registered.points, registered.T_world_scan))
      run.maps.push_back(std::move(*map));
  }
  if (auto map = builder.finish()) run.maps.push_back(std::move(*map));
  run.predicted = odometry.predicted_scans();
  return run;
}

void bind_recording(py::module_& module) {
  py::class_<Scan>(module, "Scan", "One sweep of a LiDAR.")
      .def(py::init(&scan_from), py::arg("points"), py::arg("stamp"), py::arg("times") = py::none(),
           "points (N, 3) in metres, stamp in nanoseconds, times (N,) in seconds from the stamp.")
      .def_readonly("stamp", &Scan::stamp, "int, nanoseconds")
      .def_property_readonly(
          "points", [](const Scan& s) { return array_from(s.points); },
          "(N, 3) float32, metres, in the scan's frame")
      .def_property_readonly("times", &times_of, "(N,) float32, seconds from the stamp, or None");
  py::class_<Recording>(module, "Recording", "Scans in time order, read one at a time.")
      .def("__len__", &Recording::size)
      .def(
          "__getitem__",
          [](Recording& r, py::ssize_t index) {
            const std::size_t i = index_from(index, r.size());
            const py::gil_scoped_release unlocked;
            return r.read(i);
          },
          py::arg("index"))
      .def_property_readonly("info", &info_of, "what was recognised, as a dict")
      .def_property_readonly(
          "stamps",
          [](const Recording& r) {
            Trajectory stamps(r.size());
            for (std::size_t i = 0; i < stamps.size(); ++i) stamps[i].stamp = r.stamp(i);
            return stamps_of(stamps);
          },
          "(N,) int64, nanoseconds")
      .def(
          "ground_truth",
          [](const Recording& r) -> py::object {
            const Trajectory truth = r.ground_truth();
            if (truth.empty()) return py::none();
            return py::make_tuple(stamps_of(truth), poses_of(truth));
          },
          "(stamps, poses) that came with the recording, or None");
  module.def(
      "open_recording",
      [](const std::string& path, const std::string& format, const std::string& topic,
         std::size_t first, std::optional<std::size_t> count) {
        RecordingOptions options;
        options.format = format;
        options.topic = topic;
        options.first = first;
        if (count) options.count = *count;
        const py::gil_scoped_release unlocked;
        return open_recording(path, options);
      },
      py::arg("path"), py::kw_only(), py::arg("format") = "", py::arg("topic") = "",
      py::arg("first") = 0, py::arg("count") = py::none(),
      "Opens a recording of any format; InputError where nothing known is found.");
}

void bind_odometry(py::module_& module) {
  py::class_<LocalMap>(module, "LocalMap", "Consecutive scans in the frame of the first.")
      .def_readonly("id", &LocalMap::id)
      .def_readonly("first_scan", &LocalMap::first_scan)
      .def_readonly("last_scan", &LocalMap::last_scan, "included")
      .def_property_readonly(
          "pose", [](const LocalMap& m) { return array_from(m.T_world_map); },
          "T_world_map by odometry, 4x4")
      .def_property_readonly(
          "points", [](const LocalMap& m) { return array_from(m.points); },
          "(N, 3) float32, metres");
  py::class_<RegisteredScan>(module, "RegisteredScan", "A scan with its pose.")
      .def_property_readonly(
          "pose", [](const RegisteredScan& s) { return array_from(s.T_world_scan); },
          "T_world_scan at the scan's stamp, 4x4")
      .def_property_readonly(
          "points", [](const RegisteredScan& s) { return array_from(s.points); },
          "deskewed, in the scan's frame")
      .def_readonly("predicted", &RegisteredScan::predicted, "not registered: a blocked view");
  py::class_<Odometry>(module, "Odometry",
                       "Poses scan by scan; options by the names of `groundloop config`.")
      .def(py::init([](const py::kwargs& options) {
        return std::make_unique<Odometry>(options_from<OdometryOptions>(options, "odometry"));
      }))
      .def(
          "start", [](Odometry& o, const Scan& a, const Scan& b) { o.start(a, b); },
          py::arg("first"), py::arg("second"), py::call_guard<py::gil_scoped_release>(),
          "Before the first add(): learns the velocity at the start.")
      .def(
          "add", [](Odometry& o, const Scan& scan) { return o.add(scan, "scan"); }, py::arg("scan"),
          py::call_guard<py::gil_scoped_release>(), "Registers the next scan.");
  py::class_<OdometryRun>(module, "OdometryRun", "What run_odometry() found.")
      .def_property_readonly("stamps", [](const OdometryRun& r) { return stamps_of(r.trajectory); })
      .def_property_readonly(
          "poses", [](const OdometryRun& r) { return poses_of(r.trajectory); },
          "(N, 4, 4), T_world_scan")
      .def_readonly("maps", &OdometryRun::maps)
      .def_readonly("predicted", &OdometryRun::predicted, "scans that were not registered");
  module.def(
      "run_odometry",
      [](Recording& recording, const py::object& progress, const py::kwargs& options) {
        const auto odometry = options_from<OdometryOptions>(options, "odometry");
        const Progress report = interruptible(progress);
        const py::gil_scoped_release unlocked;
        return run_odometry(recording, odometry, LocalMapOptions(), report);
      },
      py::arg("recording"), py::arg("progress") = py::none(),
      "Odometry and local maps of a whole recording. progress(stage, done, total) is called for "
      "each scan; Ctrl-C ends it.");
}

}  // namespace

void bind_frontend(py::module_& module) {
  bind_recording(module);
  bind_odometry(module);
}

}  // namespace groundloop::python
