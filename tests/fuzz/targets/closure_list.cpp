// Lists of closures of any detector, and the table of references that is kept with them, for two
// recordings of four maps.
#include "apps/commands/closure_list.hpp"

#include "apps/commands/reference_file.hpp"
#include "frontend/core/error.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace groundloop::fuzz {
static std::vector<apps::EvaluatedPart> two_parts() {
  std::vector<apps::EvaluatedPart> parts(2);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    parts[p].name = p == 0 ? "small" : "second";
    for (std::size_t scan = 0; scan < 20; ++scan) {
      parts[p].odometry.push_back({static_cast<Nanoseconds>(scan), Pose()});
      if (scan % 5 == 0)
        parts[p].maps.push_back({static_cast<int>(scan / 5), scan, scan + 4, 10, Pose()});
    }
  }
  return parts;
}
}  // namespace groundloop::fuzz

GROUNDLOOP_FUZZ_TARGET(closure_list) {
  static const std::vector<apps::EvaluatedPart> parts = two_parts();
  const auto file = scratch_file("closures.csv", text_of(input));
  try {
    if (const auto pairs = apps::read_references(file, parts, 1)) {
      for (const PairOverlap& pair : *pairs) {
        FUZZ_PROMISE(pair.reference.map >= 0 && pair.reference.map < 4);
        FUZZ_PROMISE(pair.query.map >= 0 && pair.query.map < 4);
      }
    }
  } catch (const InputError&) {
  }
  for (const ReportedClosure& closure : apps::read_closure_list(file, parts)) {
    FUZZ_PROMISE(closure.reference.map >= 0 && closure.reference.map < 4);
    FUZZ_PROMISE(closure.query.map >= 0 && closure.query.map < 4);
  }
}
