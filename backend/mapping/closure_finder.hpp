// What happens to a finished local map: it is stored, described, matched against the maps before
// it, and every candidate is verified by registration. The order of maps decides everything, timing
// nothing.
#pragma once

#include <vector>

#include "backend/registration/verification.hpp"
#include "backend/session/map_store.hpp"
#include "backend/session/session.hpp"
#include "frontend/local_maps/local_map.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {

struct ClosureOptions {
  int min_inliers = 6;
  bool verification = true;
  bool pairwise_consistency = true;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("min_inliers", self.min_inliers, Range{3, 1000}, "",
          "a candidate with fewer is not tried; more than 5 in the paper, fewer help narrow fields "
          "of view");
    field("verification", self.verification, OnOff{}, "",
          "verify and refine candidates by registration; off is the paper's plain detector, for "
          "ablations");
    field(
        "pairwise_consistency", self.pairwise_consistency, OnOff{}, "",
        "where many closures disagree over the loops they form, keep the largest set that agrees");
  }
};

/// The closure a candidate becomes, verified and refined where it has inliers enough; the sessions'
/// names are the caller's, and empty in a session of one recording. The maps are those of the given
/// ids in the stores.
[[nodiscard]] ClosureRecord verify_candidate(const ClosureCandidate& candidate, MapStore& queries,
                                             int query_id, MapStore& references, int reference_id,
                                             const ClosureOptions& closures,
                                             const VerificationOptions& verification,
                                             const RegistrationOptions& registration);

class ClosureFinder {
 public:
  ClosureFinder(const SessionFolder& folder, const LoopClosureOptions& loop_closure,
                const ClosureOptions& closures, const VerificationOptions& verification,
                const RegistrationOptions& registration);

  /// Maps in the order of their ids.
  void add(const LocalMap& map);

  [[nodiscard]] const std::vector<ClosureRecord>& closures() const { return closures_; }
  /// T_world_map by odometry.
  [[nodiscard]] const std::vector<LocalMapRecord>& maps() const { return maps_; }
  [[nodiscard]] const LoopDatabase& database() const { return database_; }
  [[nodiscard]] MapStore& store() { return store_; }
  [[nodiscard]] const LoopClosureTimes& times() const { return times_; }
  [[nodiscard]] double verification_seconds() const { return verification_seconds_; }

  /// Goes on where an interrupted run stopped.
  void restore(LoopDatabase database, std::vector<LocalMapRecord> maps,
               std::vector<ClosureRecord> closures);

 private:
  ClosureRecord verify(const ClosureCandidate& candidate);

  LoopClosureOptions loop_closure_;
  ClosureOptions options_;
  VerificationOptions verification_;
  RegistrationOptions registration_;
  MapStore store_;
  LoopDatabase database_;
  std::vector<LocalMapRecord> maps_;
  std::vector<ClosureRecord> closures_;
  LoopClosureTimes times_;
  double verification_seconds_ = 0.0;
};

}  // namespace groundloop
