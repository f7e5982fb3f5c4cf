#include "apps/commands/detection.hpp"

#include <utility>

#include "frontend/core/parallel.hpp"
#include "frontend/core/pcd.hpp"
#include "loopclosure/describe.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop::apps {

void describe_anew(StoredSession& session, const LoopClosureOptions& options,
                   const Progress& progress) {
  for (SessionPart& part : session.parts) {
    if (progress) progress("describing maps", 0, part.descriptions.size());
    parallel_for(part.descriptions.size(), 1, [&](std::size_t m) {
      const int id = part.first_map + static_cast<int>(m);
      part.descriptions[m] =
          describe_map(part.descriptions[m].key, read_pcd(session.folder.local_map(id)), options);
    });
  }
}

std::vector<ClosureRecord> match_within(const StoredSession& session, MapStore& store,
                                        const SessionMatchingOptions& options,
                                        const Progress& progress) {
  std::vector<ClosureRecord> closures;
  for (const SessionPart& part : session.parts) {
    LoopDatabase database(options.loop_closure);
    for (std::size_t m = 0; m < part.descriptions.size(); ++m) {
      if (progress) progress("matching", m, part.descriptions.size());
      for (const ClosureCandidate& candidate : database.query(part.descriptions[m])) {
        closures.push_back(verify_candidate(candidate, store, part.first_map + candidate.query.map,
                                            store, part.first_map + candidate.reference.map,
                                            options.closures, options.verification,
                                            options.registration));
        if (session.parts.size() > 1) {
          closures.back().reference_session = closures.back().query_session = part.name;
        }
      }
      database.insert(part.descriptions[m]);
    }
  }
  return closures;
}

}  // namespace groundloop::apps
