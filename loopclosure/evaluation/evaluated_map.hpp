// A local map as ground truth has it, and where two of them meet.
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "loopclosure/loop_closure.hpp"

namespace groundloop {

struct EvaluatedMap {
  MapKey key;
  /// Ground truth of its scans; the first is the map's own frame. Empty where ground truth does not
  /// cover it: such a map is left out of everything.
  std::vector<Pose> T_world_scan;
  /// Where its scans lie in the map as it was built, by odometry. Empty: as ground truth has them.
  std::vector<Pose> T_map_scan;
  /// Rebuilt at ground-truth poses, in the map's frame. Empty where overlaps are known already.
  Points points;

  [[nodiscard]] bool known() const { return !T_world_scan.empty(); }
  [[nodiscard]] const Pose& T_world_map() const { return T_world_scan.front(); }
};

/// The scans of two maps that lie nearest to each other, by ground truth.
struct MeetingScans {
  std::size_t reference = 0, query = 0;
};
[[nodiscard]] MeetingScans meeting_scans(const EvaluatedMap& reference, const EvaluatedMap& query);

/// The pose between two scans, T_query_reference, that one between their maps means: maps are bent
/// by the drift inside them, and where they meet is where a closure ties them.
[[nodiscard]] Pose at_meeting(const Pose& T_query_reference, const EvaluatedMap& reference,
                              const EvaluatedMap& query, const MeetingScans& scans);
/// The same pose by ground truth.
[[nodiscard]] Pose true_at_meeting(const EvaluatedMap& reference, const EvaluatedMap& query,
                                   const MeetingScans& scans);

}  // namespace groundloop
