// groundloop's own detector on finished sessions, with another configuration than they were made
// with: descriptions made anew from their local maps, and the closures of a session within itself.
#pragma once

#include "apps/config/config.hpp"
#include "backend/merging/session_matching.hpp"
#include "backend/session/map_store.hpp"
#include "backend/session/stored_session.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop::apps {

/// Replaces the descriptions of all parts by those of this configuration.
void describe_anew(StoredSession& session, const LoopClosureOptions& options,
                   const Progress& progress);

/// Candidates of each recording's maps among the maps before them, as a run finds them; verified
/// where the options say so.
[[nodiscard]] std::vector<ClosureRecord> match_within(const StoredSession& session, MapStore& store,
                                                      const SessionMatchingOptions& options,
                                                      const Progress& progress);

}  // namespace groundloop::apps
