#include "backend/mapping/closure_finder.hpp"

#include <algorithm>
#include <chrono>

#include "loopclosure/describe.hpp"

namespace groundloop {
namespace {

// Information of the detector's own pose where nothing was verified: 1 m and 1.5 degrees, the
// paper's Table 7.
Matrix6d detector_information() {
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << 1.0, 1.0, 1.0, 1.0 / (0.026 * 0.026), 1.0 / (0.026 * 0.026),
      1.0 / (0.026 * 0.026);
  return information;
}

}  // namespace

ClosureRecord verify_candidate(const ClosureCandidate& candidate, MapStore& queries, int query_id,
                               MapStore& references, int reference_id,
                               const ClosureOptions& closures,
                               const VerificationOptions& verification,
                               const RegistrationOptions& registration) {
  ClosureRecord record;
  record.reference_map = candidate.reference.map;
  record.query_map = candidate.query.map;
  record.matches = candidate.matches;
  record.inliers = candidate.inliers;
  record.T_query_reference = record.initial_T_query_reference = candidate.T_query_reference;
  if (candidate.inliers < closures.min_inliers) {
    record.status = ClosureStatus::few_inliers;
    return record;
  }
  if (!closures.verification) {
    record.status = ClosureStatus::accepted;
    record.information = detector_information();
    return record;
  }
  const std::shared_ptr<StoredMap> query = queries.get(query_id);
  const std::shared_ptr<StoredMap> reference = references.get(reference_id);
  VerificationOptions limits = verification;
  if (candidate.inliers >= limits.vouching_inliers)
    limits.min_agreement = std::min(limits.min_agreement, limits.vouched_agreement);
  const ClosureVerification result =
      verify_closure(query->target(), query->points(), reference->points(),
                     candidate.T_query_reference, limits, registration);
  record.status = result.status;
  record.T_query_reference = result.T_query_reference;
  record.information = result.information;
  record.overlap = result.overlap;
  record.rmse = result.rmse;
  record.agreement = result.agreement;
  return record;
}

ClosureFinder::ClosureFinder(const SessionFolder& folder, const LoopClosureOptions& loop_closure,
                             const ClosureOptions& closures,
                             const VerificationOptions& verification,
                             const RegistrationOptions& registration)
    : loop_closure_(loop_closure),
      options_(closures),
      verification_(verification),
      registration_(registration),
      store_(folder, registration),
      database_(loop_closure) {}

void ClosureFinder::add(const LocalMap& map) {
  store_.put(map);
  maps_.push_back({map.id, map.first_scan, map.last_scan, map.points.size(), map.T_world_map});
  LoopClosureTimes times;
  MapDescription description = describe_map({0, map.id}, map.points, loop_closure_, &times);
  for (const ClosureCandidate& candidate : database_.query(description, &times)) {
    closures_.push_back(verify(candidate));
  }
  times_.add_map(times);
  database_.insert(std::move(description));
}

ClosureRecord ClosureFinder::verify(const ClosureCandidate& candidate) {
  const auto start = std::chrono::steady_clock::now();
  ClosureRecord record =
      verify_candidate(candidate, store_, candidate.query.map, store_, candidate.reference.map,
                       options_, verification_, registration_);
  verification_seconds_ +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return record;
}

void ClosureFinder::restore(LoopDatabase database, std::vector<LocalMapRecord> maps,
                            std::vector<ClosureRecord> closures) {
  database_ = std::move(database);
  maps_ = std::move(maps);
  closures_ = std::move(closures);
}

}  // namespace groundloop
