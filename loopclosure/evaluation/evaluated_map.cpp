#include "loopclosure/evaluation/evaluated_map.hpp"

#include <limits>

namespace groundloop {
namespace {

Pose T_map_scan(const EvaluatedMap& map, std::size_t scan) {
  return map.T_map_scan.empty() ? map.T_world_map().inverse() * map.T_world_scan[scan]
                                : map.T_map_scan[scan];
}

}  // namespace

MeetingScans meeting_scans(const EvaluatedMap& reference, const EvaluatedMap& query) {
  MeetingScans best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t q = 0; q < query.T_world_scan.size(); ++q) {
    for (std::size_t r = 0; r < reference.T_world_scan.size(); ++r) {
      const double squared =
          (query.T_world_scan[q].translation - reference.T_world_scan[r].translation).squaredNorm();
      if (squared < least) least = squared, best = {r, q};
    }
  }
  return best;
}

Pose at_meeting(const Pose& T_query_reference, const EvaluatedMap& reference,
                const EvaluatedMap& query, const MeetingScans& scans) {
  return T_map_scan(query, scans.query).inverse() * T_query_reference *
         T_map_scan(reference, scans.reference);
}

Pose true_at_meeting(const EvaluatedMap& reference, const EvaluatedMap& query,
                     const MeetingScans& scans) {
  return query.T_world_scan[scans.query].inverse() * reference.T_world_scan[scans.reference];
}

}  // namespace groundloop
