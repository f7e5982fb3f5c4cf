#include "backend/registration/verification.hpp"

#include <array>
#include <cstdio>

#include "backend/registration/overlap.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

std::string below(const char* what, double value, double limit) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "%s %.3f is below %.3f", what, value, limit);
  return text.data();
}

double overlap_of(const RegistrationTarget& target, const Points& query, const Points& reference,
                  const Pose& T_query_reference) {
  constexpr double kVoxel = 0.5;
  const VoxelLevel& finest = target.pyramid().finest();
  return finest.voxel_size == static_cast<float>(kVoxel)
             ? volumetric_overlap(reference, finest, T_query_reference)
             : volumetric_overlap(reference, query, T_query_reference, kVoxel);
}

}  // namespace

const char* to_string(ClosureStatus status) {
  switch (status) {
    case ClosureStatus::accepted:
      return "accepted";
    case ClosureStatus::few_inliers:
      return "few_inliers";
    case ClosureStatus::icp_diverged:
      return "icp_diverged";
    case ClosureStatus::low_overlap:
      return "low_overlap";
    case ClosureStatus::inconsistent:
      return "inconsistent";
    case ClosureStatus::outlier:
      return "outlier";
  }
  return "";
}

ClosureVerification verify_closure(const RegistrationTarget& query_target, const Points& query,
                                   const Points& reference, const Pose& T_query_reference_initial,
                                   const VerificationOptions& verification,
                                   const RegistrationOptions& registration) {
  const RegistrationResult icp =
      register_points(query_target, reference, T_query_reference_initial, registration);
  ClosureVerification result;
  result.T_query_reference = icp.T_target_source;
  result.information = icp.information;
  result.rmse = icp.rmse;
  if (!icp.converged) {
    result.status = ClosureStatus::icp_diverged;
    result.reason = icp.failure;
    return result;
  }
  ColumnAgreement agreement;
  std::optional<ColumnContrast> contrast;
  // The two judges are independent and each walks over all points in order.
  parallel_for(2, 1, [&](std::size_t judge) {
    if (judge == 0) {
      result.overlap = overlap_of(query_target, query, reference, icp.T_target_source);
    } else {
      const ColumnGrid columns(reference, icp.T_target_source, query_target.up());
      agreement = query_target.columns().agreement(columns);
      if (agreement.correlation < verification.min_agreement)
        contrast = query_target.columns().contrast(columns);
    }
  });
  result.agreement = agreement.correlation;
  if (contrast && contrast->defined) result.contrast = contrast->margin();
  const double min_overlap =
      agreement.defined ? verification.min_overlap : verification.min_overlap_without_structure;
  result.status = ClosureStatus::low_overlap;
  if (result.overlap < min_overlap) {
    result.reason = below("overlap", result.overlap, min_overlap);
  } else if (agreement.defined && agreement.correlation < verification.min_agreement &&
             result.contrast.value_or(-1.0) < verification.contrast_limit()) {
    result.reason =
        below("agreement of tall structure", agreement.correlation, verification.min_agreement);
  } else {
    result.status = ClosureStatus::accepted;
  }
  return result;
}

}  // namespace groundloop
