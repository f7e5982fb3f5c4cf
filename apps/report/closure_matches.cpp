#include "apps/report/closure_matches.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "loopclosure/loop_database.hpp"

namespace groundloop::apps {
namespace {

// Places in `which` of the closures between two recordings, by query map.
using ByQuery = std::map<int, std::vector<std::size_t>>;

ShownMatches judge(const MapDescription& query, const MapDescription& reference,
                   std::vector<KeypointMatch> matches, const ConsensusOptions& options) {
  const Consensus consensus = find_consensus(query, reference, matches, options);
  ShownMatches shown;
  for (const KeypointMatch& match : matches) {
    shown.inlier.push_back(std::any_of(
        consensus.inliers.begin(), consensus.inliers.end(), [&](const KeypointMatch& inlier) {
          return inlier.query == match.query && inlier.reference == match.reference;
        }));
  }
  shown.matches = std::move(matches);
  return shown;
}

class Finder {
 public:
  Finder(const SessionContents& contents, const std::vector<std::size_t>& which)
      : contents_(contents), which_(which), shown_(which.size()) {}

  void within(const SessionPart& part, const ByQuery& wanted) {
    LoopDatabase database(options());
    for (MapDescription description : part.descriptions) {
      description.key.session = 0;
      match(database, description, part, wanted);
      database.insert(std::move(description));
    }
  }

  void between(const SessionPart& reference, const SessionPart& query, const ByQuery& wanted) {
    LoopDatabase database(options());
    for (MapDescription description : reference.descriptions) {
      description.key.session = 0;
      database.insert(std::move(description));
    }
    for (MapDescription description : query.descriptions) {
      description.key.session = 1;
      match(database, description, reference, wanted);
    }
  }

  [[nodiscard]] std::vector<ShownMatches> take() { return std::move(shown_); }

 private:
  [[nodiscard]] const LoopClosureOptions& options() const {
    return contents_.config.slam.loop_closure;
  }

  void match(const LoopDatabase& database, const MapDescription& query,
             const SessionPart& reference_part, const ByQuery& wanted) {
    const auto found = wanted.find(query.key.map);
    if (found == wanted.end()) return;
    std::vector<std::vector<KeypointMatch>> matches = database.match(query);
    for (const std::size_t w : found->second) {
      const int reference = contents_.session.closures[which_[w]].reference_map;
      if (static_cast<std::size_t>(reference) >= matches.size()) continue;
      const auto r = static_cast<std::size_t>(reference);
      shown_[w] = judge(query, reference_part.descriptions[r], matches[r], options().consensus);
    }
  }

  const SessionContents& contents_;
  const std::vector<std::size_t>& which_;
  std::vector<ShownMatches> shown_;
};

}  // namespace

std::vector<ShownMatches> find_matches(const SessionContents& contents,
                                       const std::vector<std::size_t>& which) {
  std::map<std::pair<std::string, std::string>, ByQuery> pairs;
  for (std::size_t w = 0; w < which.size(); ++w) {
    const ClosureRecord& c = contents.session.closures[which[w]];
    if (c.source == ClosureSource::detector)
      pairs[{c.reference_session, c.query_session}][c.query_map].push_back(w);
  }
  Finder finder(contents, which);
  for (const auto& [names, wanted] : pairs) {
    const SessionPart& reference = contents.session.parts[contents.part_index(names.first)];
    if (names.first == names.second) {
      finder.within(reference, wanted);
    } else {
      finder.between(reference, contents.session.parts[contents.part_index(names.second)], wanted);
    }
  }
  return finder.take();
}

}  // namespace groundloop::apps
