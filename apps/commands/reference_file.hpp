// Overlaps of a session's maps at ground truth, kept as a table: computed once, they serve every
// list of closures of the session, and other programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "apps/commands/evaluated_sessions.hpp"
#include "loopclosure/evaluation/reference_closures.hpp"

namespace groundloop::apps {

/// Ties a table to maps, their ground truth and how overlaps were computed.
[[nodiscard]] std::uint64_t reference_fingerprint(const std::vector<EvaluatedPart>& parts,
                                                  const std::vector<EvaluatedMap>& maps,
                                                  const ReferenceOptions& options);

/// Header reference_session,reference_map,query_session,query_map,overlap,reference,uncertain,
/// direction,distance_m; reference and uncertain by the options' thresholds.
void write_references(const std::filesystem::path& file, const std::vector<EvaluatedPart>& parts,
                      const std::vector<PairOverlap>& pairs, const ReferenceOptions& options,
                      std::uint64_t fingerprint);

/// Empty where there is no such file, or it is of other maps. Throws InputError where it is
/// damaged.
[[nodiscard]] std::optional<std::vector<PairOverlap>> read_references(
    const std::filesystem::path& file, const std::vector<EvaluatedPart>& parts,
    std::uint64_t fingerprint);

}  // namespace groundloop::apps
