// What the baselines read of a session: its scans, where odometry put them, and the local maps that
// they belong to. And the list that they write.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backend/session/session.hpp"
#include "frontend/core/trajectory.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::baselines {

class SessionScans {
 public:
  /// Throws InputError where the session is not complete, or its recording is not there.
  explicit SessionScans(const std::filesystem::path& session);

  [[nodiscard]] std::size_t size() const { return odometry_.size(); }
  [[nodiscard]] const Pose& T_world_scan(std::size_t scan) const { return odometry_[scan].pose; }
  /// Number of the local map that a scan belongs to.
  [[nodiscard]] int map_of(std::size_t scan) const { return map_of_[scan]; }
  /// Points of a scan within 100 m, in its frame at its stamp, deskewed by the odometry.
  /// To be called from any thread; recordings are read one scan at a time.
  [[nodiscard]] Points points(std::size_t scan) const;

 private:
  std::unique_ptr<Recording> recording_;
  mutable std::mutex reading_;
  Trajectory odometry_;
  std::vector<std::size_t> numbers_;  ///< in the recording
  std::vector<int> map_of_;
};

/// Whether a scan may be reported for a query: of another session, or of a map older than the three
/// before the query's.
[[nodiscard]] bool may_report(const SessionScans& references, std::size_t reference,
                              const SessionScans& queries, std::size_t query);

/// Pairs of local maps with the best score of any of their scans: a closure between scans counts
/// for their maps (Sec. 4.4 of the paper).
class MapPairs {
 public:
  /// T_query_reference between the two scans, if there is one.
  void add(const SessionScans& references, std::size_t reference, const SessionScans& queries,
           std::size_t query, double score, const std::optional<Pose>& T_query_reference);
  /// reference_scan,query_scan,score and the pose: the best pair of scans of each pair of maps.
  void write(const std::filesystem::path& file) const;
  [[nodiscard]] std::size_t size() const { return best_.size(); }

 private:
  struct Best {
    std::size_t reference, query;
    double score;
    std::optional<Pose> T_query_reference;
  };
  std::map<std::pair<int, int>, Best> best_;  ///< by query map, reference map
};

}  // namespace groundloop::baselines
