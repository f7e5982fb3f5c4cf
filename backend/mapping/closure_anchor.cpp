#include "backend/mapping/closure_anchor.hpp"

#include <limits>
#include <vector>

#include <Eigen/LU>

namespace groundloop {
namespace {

// Scans this much farther apart than the closest are of the meeting as well, m.
constexpr double kMeeting = 10.0;

Pose in_map(const LocalMapRecord& map, const Trajectory& trajectory, std::size_t scan) {
  return trajectory[map.first_scan].pose.inverse() * trajectory[scan].pose;
}

// From the first scan of the map to `scan`.
RelativePose way_to(std::size_t scan, const LocalMapRecord& map, const Trajectory& trajectory,
                    const OdometryInformationOptions& drift) {
  std::vector<Pose> way;
  way.reserve(scan - map.first_scan + 1);
  for (std::size_t i = map.first_scan; i <= scan; ++i) way.push_back(trajectory[i].pose);
  return compose_odometry(way, 0, way.size() - 1, drift);
}

}  // namespace

ClosureAnchor anchor_closure(const Pose& T_query_reference, const LocalMapRecord& reference,
                             const Trajectory& reference_odometry, const LocalMapRecord& query,
                             const Trajectory& query_odometry) {
  std::vector<Eigen::Vector3d> places;  // of the query's scans, in its map
  for (std::size_t j = query.first_scan; j <= query.last_scan; ++j)
    places.push_back(in_map(query, query_odometry, j).translation);
  struct Meeting {
    std::size_t reference, query;
    double distance;
  };
  std::vector<Meeting> meetings;
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t i = reference.first_scan; i <= reference.last_scan; ++i) {
    const Eigen::Vector3d place =
        T_query_reference * in_map(reference, reference_odometry, i).translation;
    Meeting best{i, query.first_scan, std::numeric_limits<double>::infinity()};
    for (std::size_t j = 0; j < places.size(); ++j) {
      const double distance = (places[j] - place).norm();
      if (distance < best.distance) best = {i, query.first_scan + j, distance};
    }
    closest = std::min(closest, best.distance);
    meetings.push_back(best);
  }
  std::erase_if(meetings, [&](const Meeting& m) { return m.distance > closest + kMeeting; });
  const Meeting& middle = meetings[meetings.size() / 2];
  return {middle.query, middle.reference,
          in_map(query, query_odometry, middle.query).inverse() * T_query_reference *
              in_map(reference, reference_odometry, middle.reference)};
}

Pose carried_to_origins(const ClosureAnchor& anchor, const LocalMapRecord& reference,
                        const Trajectory& reference_trajectory, const LocalMapRecord& query,
                        const Trajectory& query_trajectory) {
  return in_map(query, query_trajectory, anchor.query_scan) * anchor.T_query_reference *
         in_map(reference, reference_trajectory, anchor.reference_scan).inverse();
}

Matrix6d information_between_origins(const ClosureAnchor& anchor, const Matrix6d& information,
                                     const LocalMapRecord& reference,
                                     const Trajectory& reference_trajectory,
                                     const LocalMapRecord& query,
                                     const Trajectory& query_trajectory,
                                     const OdometryInformationOptions& drift) {
  const RelativePose exact{anchor.T_query_reference, Matrix6d::Zero()};
  const Matrix6d lost =
      (way_to(anchor.query_scan, query, query_trajectory, drift) * exact *
       inverse(way_to(anchor.reference_scan, reference, reference_trajectory, drift)))
          .covariance;
  // (information^-1 + lost)^-1, also where a direction is free and information has no inverse.
  const Matrix6d left = Matrix6d::Identity() + information * lost;
  const Matrix6d result = left.partialPivLu().solve(information);
  return 0.5 * (result + result.transpose());
}

}  // namespace groundloop
