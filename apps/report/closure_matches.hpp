// The keypoint matches behind the candidates of closures.csv, found again from the loop database as
// the run found them: maps entered the database one after another, and a map was matched against
// those before it; between recordings, against all maps of the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "apps/report/session_contents.hpp"
#include "loopclosure/consensus.hpp"

namespace groundloop::apps {

struct ShownMatches {
  std::vector<KeypointMatch> matches;
  std::vector<bool> inlier;  ///< one a match: kept by the consensus
};

/// Of the closures at `which` (places in the session's closures), one each; none where the closure
/// was not found by the detector.
[[nodiscard]] std::vector<ShownMatches> find_matches(const SessionContents& contents,
                                                     const std::vector<std::size_t>& which);

}  // namespace groundloop::apps
