// A closure between two clouds: found by their density images, verified by registration.
#include <optional>

#include <pybind11/stl.h>

#include "apps/python/arrays.hpp"
#include "backend/registration/verification.hpp"
#include "loopclosure/describe.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop::python {
namespace {

struct Closure {
  int matches = 0;
  int inliers = 0;
  ClosureVerification verification;
};

// Between sessions, so that no maps are skipped; at least three inliers, as the tables have it.
std::optional<ClosureCandidate> detect(const Points& query, const Points& reference) {
  const LoopClosureOptions options;
  LoopDatabase database(options);
  database.insert(describe_map({0, 0}, reference, options));
  const std::vector<ClosureCandidate> found = database.query(describe_map({1, 0}, query, options));
  if (found.empty()) return std::nullopt;
  return found.front();
}

std::optional<Closure> close(const Points& query, const Points& reference,
                             const std::optional<Pose>& initial) {
  Closure closure;
  Pose T_query_reference;
  if (initial) {
    T_query_reference = *initial;
  } else {
    const std::optional<ClosureCandidate> candidate = detect(query, reference);
    if (!candidate) return std::nullopt;
    closure.matches = candidate->matches;
    closure.inliers = candidate->inliers;
    T_query_reference = candidate->T_query_reference;
  }
  const RegistrationTarget target(query, RegistrationOptions());
  VerificationOptions verification;
  verification.between_sessions = true;
  closure.verification = verify_closure(target, query, reference, T_query_reference, verification);
  return closure;
}

}  // namespace

void bind_closures(py::module_& module) {
  py::class_<Closure>(module, "Closure", "How two clouds lie to each other, and the verdict.")
      .def_readonly("matches", &Closure::matches)
      .def_readonly("inliers", &Closure::inliers, "0 where the pose was given")
      .def_property_readonly(
          "accepted",
          [](const Closure& c) { return c.verification.status == ClosureStatus::accepted; })
      .def_property_readonly("status",
                             [](const Closure& c) { return to_string(c.verification.status); })
      .def_property_readonly(
          "reason", [](const Closure& c) { return c.verification.reason; },
          "one sentence, empty where accepted")
      .def_property_readonly(
          "pose", [](const Closure& c) { return array_from(c.verification.T_query_reference); },
          "T_query_reference, 4x4: maps the reference's points into the query's frame")
      .def_property_readonly(
          "information", [](const Closure& c) { return array_from(c.verification.information); },
          "6x6 of the pose, perturbed on the right; translation, rotation; metres, radians")
      .def_property_readonly(
          "overlap", [](const Closure& c) { return c.verification.overlap; },
          "share of the smaller cloud's voxels of 0.5 m")
      .def_property_readonly(
          "rmse", [](const Closure& c) { return c.verification.rmse; },
          "metres, of the registration");
  module.def(
      "close",
      [](const PointArray& query, const PointArray& reference,
         const std::optional<NumberArray>& initial) {
        const Points q = points_from(query);
        const Points r = points_from(reference);
        std::optional<Pose> pose;
        if (initial) pose = pose_from(*initial);
        const py::gil_scoped_release unlocked;
        return close(q, r, pose);
      },
      py::arg("query"), py::arg("reference"), py::arg("initial") = py::none(),
      "The closure between two clouds of some 100 m, (N, 3) each: found by their density images, "
      "or started at `initial` (T_query_reference), and verified. None where nothing is found.");
}

}  // namespace groundloop::python
