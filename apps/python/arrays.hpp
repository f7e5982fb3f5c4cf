// Between numpy arrays and the types of the libraries. Points are (N, 3) float32, poses 4x4
// float64, many poses (N, 4, 4), stamps int64 nanoseconds. What goes out is a copy.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "frontend/core/error.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/core/spelling.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::python {
namespace py = pybind11;

using PointArray = py::array_t<float, py::array::c_style | py::array::forcecast>;
using NumberArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Throws InputError unless the array is (N, 3) or wider; further columns are left out, and so are
/// points that are not finite.
[[nodiscard]] Points points_from(const PointArray& array);
[[nodiscard]] py::array_t<float> array_from(const Points& points);

/// Throws InputError unless the array is 4x4 with a rotation in it.
[[nodiscard]] Pose pose_from(const NumberArray& array);
[[nodiscard]] py::array_t<double> array_from(const Pose& pose);
[[nodiscard]] py::array_t<double> array_from(const Matrix6d& matrix);
[[nodiscard]] Matrix6d matrix_from(const NumberArray& array);

/// "stamps" (N,) and "poses" (N, 4, 4).
[[nodiscard]] py::array_t<std::int64_t> stamps_of(const Trajectory& trajectory);
[[nodiscard]] py::array_t<double> poses_of(const Trajectory& trajectory);

/// For work that released the interpreter's lock: takes it, and lets Ctrl-C through as
/// KeyboardInterrupt; hands progress to `callback` unless it is None.
[[nodiscard]] Progress interruptible(const py::object& callback);

/// Options from keyword arguments, by the names that the configuration has. Throws InputError for
/// an unknown name, naming the nearest, and for a value out of its range.
template <typename Options>
Options options_from(const py::kwargs& keywords, const std::string& section) {
  Options options;
  std::vector<std::string> known;
  Options::visit(options, [&](const char* key, auto& value, const auto&, const char*, const char*) {
    known.emplace_back(key);
    if (keywords.contains(key))
      value = py::cast<std::decay_t<decltype(value)>>(py::object(keywords[key]));
  });
  for (const auto& item : keywords) {
    const auto name = py::cast<std::string>(item.first);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError(section + ": unknown option '" + name + "'" + suggestion(name, known));
  }
  validate(options, section);
  return options;
}

void bind_frontend(py::module_& module);
void bind_closures(py::module_& module);
void bind_graphs(py::module_& module);
void bind_sessions(py::module_& module);

}  // namespace groundloop::python
