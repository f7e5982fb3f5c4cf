// Closures between two recordings: the query's maps are matched against the reference's tree, their
// own features never inserted, and every candidate is verified by registration. And the file in
// which such closures travel from a `groundloop match` to a merge.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "backend/mapping/closure_finder.hpp"
#include "backend/session/stored_session.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop {

struct SessionMatchingOptions {
  LoopClosureOptions loop_closure;
  ClosureOptions closures;
  VerificationOptions verification;
  RegistrationOptions registration;
};

/// All candidates of a pair of recordings, accepted or not.
struct PairMatches {
  std::string reference, query;
  std::uint64_t reference_fingerprint = 0, query_fingerprint = 0;
  std::vector<ClosureRecord> closures;
};

/// `references` and `queries` are the stores of the sessions the parts belong to.
[[nodiscard]] PairMatches match_parts(const SessionPart& reference, MapStore& references,
                                      const SessionPart& query, MapStore& queries,
                                      const SessionMatchingOptions& options,
                                      LoopClosureTimes* times = nullptr,
                                      const Progress& progress = {});

/// Writes closures.csv's columns and the information of each closure, below lines that name
/// version, pairs and the fingerprints of their sessions.
void write_matches(const std::filesystem::path& file, const std::vector<PairMatches>& pairs);
/// Throws InputError naming file and line where it is of another version, damaged or cut off.
[[nodiscard]] std::vector<PairMatches> read_matches(const std::filesystem::path& file);

}  // namespace groundloop
