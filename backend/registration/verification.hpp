// Decides whether a loop-closure candidate becomes a constraint: ICP refines its pose, then
// convergence, volumetric overlap and the agreement of tall structure judge it. Strictly periodic
// places (the arches of a bridge) pass all three; only consistency with odometry and with other
// closures rejects them (robust solving).
#pragma once

#include <optional>
#include <string>

#include "backend/registration/registration.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"

namespace groundloop {

/// The column `status` of closures.csv.
enum class ClosureStatus {
  accepted,
  few_inliers,
  icp_diverged,
  low_overlap,
  inconsistent,
  outlier
};
[[nodiscard]] const char* to_string(ClosureStatus status);

struct VerificationOptions {
  double min_overlap = 0.25;
  double min_agreement = 0.55;
  int vouching_inliers = 15;
  double vouched_agreement = 0.4;
  double min_overlap_without_structure = 0.5;
  double min_contrast = 0.15;
  double min_contrast_between_sessions = 0.1;
  /// Set where two sessions are compared.
  bool between_sessions = false;

  [[nodiscard]] double contrast_limit() const {
    return between_sessions ? min_contrast_between_sessions : min_contrast;
  }

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("min_overlap", self.min_overlap, Range{0.0, 1.0}, "",
          "shared 0.5 m voxels over those of the smaller map; true closures of the real drive have "
          "0.28 and more, wrong ones up to 0.47");
    field("min_agreement", self.min_agreement, Range{-1.0, 1.0}, "",
          "correlation of tall and flat columns; on the real drive true closures have 0.63 and "
          "more, wrong ones 0.53 at most (the same street 150 m on)");
    field("vouching_inliers", self.vouching_inliers, Range{3, 10000}, "",
          "a candidate with so many inliers of the density images has two witnesses; wrong ones "
          "have 10 at most outside strictly periodic places, and");
    field("vouched_agreement", self.vouched_agreement, Range{-1.0, 1.0}, "",
          "this agreement is enough of it; true ones of a simulated town have 0.43 and more");
    field("min_overlap_without_structure", self.min_overlap_without_structure, Range{0.0, 1.0}, "",
          "asked where all columns are flat or all tall, so that nothing can be correlated");
    field(
        "min_contrast", self.min_contrast, Range{0.0, 2.0}, "",
        "less agreement is enough where it is above that of all places up to 20 m beside by this: "
        "of 500 wrong alignments (real drive, towns, bridge) none came above 0.10, true ones that "
        "agree too little have 0.14 to 0.38");
    field(
        "min_contrast_between_sessions", self.min_contrast_between_sessions, Range{0.0, 2.0}, "",
        "likewise between sessions, whose sensors agree less everywhere; 1 of 78 wrong alignments "
        "came to 0.09, the others to 0.01");
  }
};

struct ClosureVerification {
  ClosureStatus status = ClosureStatus::icp_diverged;
  Pose T_query_reference;                   ///< refined
  Matrix6d information = Matrix6d::Zero();  ///< of T_query_reference, see RegistrationResult
  double overlap = 0.0;
  double agreement = 0.0;          ///< ColumnAgreement::correlation
  std::optional<double> contrast;  ///< ColumnContrast::margin() where it was asked
  double rmse = 0.0;
  std::string reason;  ///< one sentence, empty where accepted
};

/// `query` are the points `query_target` was built from. Poses map reference-map points into the
/// query map.
[[nodiscard]] ClosureVerification verify_closure(const RegistrationTarget& query_target,
                                                 const Points& query, const Points& reference,
                                                 const Pose& T_query_reference_initial,
                                                 const VerificationOptions& verification = {},
                                                 const RegistrationOptions& registration = {});

}  // namespace groundloop
