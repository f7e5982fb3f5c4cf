#include <algorithm>
#include <cmath>
#include <cstring>

#include "apps/python/arrays.hpp"

namespace groundloop::python {
namespace {

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t d = 0; d < array.ndim(); ++d)
    text += (d > 0 ? ", " : "") + std::to_string(array.shape(d));
  return text + ")";
}

void check_square(const NumberArray& array, py::ssize_t side, const char* what) {
  if (array.ndim() == 2 && array.shape(0) == side && array.shape(1) == side) return;
  throw InputError(std::string(what) + ": expected an array of " + std::to_string(side) + "x" +
                   std::to_string(side) + ", got " + shape_of(array));
}

template <typename Matrix>
py::array_t<double> square(const Matrix& matrix) {
  py::array_t<double> array({matrix.rows(), matrix.cols()});
  auto a = array.mutable_unchecked<2>();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) a(r, c) = matrix(r, c);
  }
  return array;
}

}  // namespace

Points points_from(const PointArray& array) {
  if (array.ndim() != 2 || array.shape(1) < 3)
    throw InputError("points: expected an array of (N, 3), got " + shape_of(array));
  const auto a = array.unchecked<2>();
  Points points;
  points.reserve(static_cast<std::size_t>(a.shape(0)));
  for (py::ssize_t i = 0; i < a.shape(0); ++i) {
    const Eigen::Vector3f point(a(i, 0), a(i, 1), a(i, 2));
    if (point.allFinite()) points.push_back(point);
  }
  return points;
}

py::array_t<float> array_from(const Points& points) {
  py::array_t<float> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  if (!points.empty())
    std::memcpy(array.mutable_data(), points.data(), points.size() * sizeof(Eigen::Vector3f));
  return array;
}

Pose pose_from(const NumberArray& array) {
  check_square(array, 4, "pose");
  const auto a = array.unchecked<2>();
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  for (py::ssize_t r = 0; r < 3; ++r) {
    for (py::ssize_t c = 0; c < 3; ++c) rotation(r, c) = a(r, c);
    translation(r) = a(r, 3);
  }
  const bool proper =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 &&
      rotation.determinant() > 0.0 && translation.allFinite();
  if (!proper)
    throw InputError("pose: the upper left 3x3 is no rotation, or a number is not finite");
  return Pose(rotation, translation);
}

py::array_t<double> array_from(const Pose& pose) { return square(pose.matrix()); }
py::array_t<double> array_from(const Matrix6d& matrix) { return square(matrix); }

Matrix6d matrix_from(const NumberArray& array) {
  check_square(array, 6, "information");
  const auto a = array.unchecked<2>();
  Matrix6d matrix;
  for (py::ssize_t r = 0; r < 6; ++r) {
    for (py::ssize_t c = 0; c < 6; ++c) matrix(r, c) = a(r, c);
  }
  return matrix;
}

py::array_t<std::int64_t> stamps_of(const Trajectory& trajectory) {
  py::array_t<std::int64_t> array(static_cast<py::ssize_t>(trajectory.size()));
  auto a = array.mutable_unchecked<1>();
  for (std::size_t i = 0; i < trajectory.size(); ++i)
    a(static_cast<py::ssize_t>(i)) = trajectory[i].stamp;
  return array;
}

py::array_t<double> poses_of(const Trajectory& trajectory) {
  const auto n = static_cast<py::ssize_t>(trajectory.size());
  py::array_t<double> array({n, py::ssize_t{4}, py::ssize_t{4}});
  auto a = array.mutable_unchecked<3>();
  for (py::ssize_t i = 0; i < n; ++i) {
    const Eigen::Matrix4d m = trajectory[static_cast<std::size_t>(i)].pose.matrix();
    for (py::ssize_t r = 0; r < 4; ++r) {
      for (py::ssize_t c = 0; c < 4; ++c) a(i, r, c) = m(r, c);
    }
  }
  return array;
}

Progress interruptible(const py::object& callback) {
  return [&callback](const std::string& stage, std::size_t done, std::size_t total) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!callback.is_none()) callback(stage, done, total);
  };
}

}  // namespace groundloop::python

PYBIND11_MODULE(_groundloop, module) {
  using namespace groundloop::python;
  module.doc() = "The compiled part of groundloop.";
  module.attr("__version__") = GROUNDLOOP_VERSION;
  py::register_exception<groundloop::InputError>(module, "InputError", PyExc_ValueError);
  bind_frontend(module);
  bind_closures(module);
  bind_graphs(module);
  bind_sessions(module);
}
