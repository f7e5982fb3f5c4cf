#include "loopclosure/loop_database.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "frontend/core/error.hpp"
#include "loopclosure/hamming.hpp"
#include "loopclosure/stopwatch.hpp"

namespace groundloop {
namespace {

// One number of a pair of maps, the same in every run.
std::uint64_t seed_of(const MapKey& a, const MapKey& b) {
  std::uint64_t seed = 0;
  for (const int value : {a.session, a.map, b.session, b.map}) {
    seed = (seed ^ static_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15ULL;
    seed ^= seed >> 29;
  }
  return seed;
}

// Trees kept for a database of this many descriptors. Deeper trees cost more a search; what fewer
// of them miss, guided matching finds again once some matches have given the alignment.
std::size_t trees_for(std::size_t trees, std::size_t descriptors) {
  constexpr std::size_t kSmall = 1U << 16, kLarge = 1U << 20;
  const std::size_t part = descriptors <= kSmall ? 1 : descriptors <= kLarge ? 2 : 4;
  return std::max<std::size_t>(1, trees / part);
}

HammingForest make_forest(const MatchingOptions& options) {
  return HammingForest(static_cast<std::size_t>(options.method == "tree" ? 1 : options.trees),
                       static_cast<std::size_t>(options.leaf_size), options.max_imbalance);
}

// Of the matches of each feature of the query, in their order, the nearest alone.
void keep_nearest(std::vector<KeypointMatch>& matches) {
  std::vector<KeypointMatch> kept;
  for (const KeypointMatch& match : matches) {
    if (kept.empty() || kept.back().query != match.query) {
      kept.push_back(match);
    } else if (match.distance < kept.back().distance) {
      kept.back() = match;
    }
  }
  matches = std::move(kept);
}

}  // namespace

LoopDatabase::LoopDatabase(const LoopClosureOptions& options)
    : options_(options), forest_(make_forest(options.matching)) {}

void LoopDatabase::insert(MapDescription description) {
  check(description.keypoints.size() == description.descriptors.size(),
        "a description has one descriptor a keypoint");
  check(std::none_of(descriptions_.begin(), descriptions_.end(),
                     [&](const MapDescription& d) { return d.key == description.key; }),
        "a map enters the loop database once");
  descriptions_.push_back(std::move(description));
  insert_features(static_cast<std::uint32_t>(descriptions_.size() - 1));
}

void LoopDatabase::insert_features(std::uint32_t index) {
  const std::vector<Descriptor>& descriptors = descriptions_[index].descriptors;
  forest_.insert(descriptors);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    origins_.push_back({index, static_cast<std::uint32_t>(i)});
  }
  if (options_.matching.method == "forest") {
    forest_.keep_trees(
        trees_for(static_cast<std::size_t>(options_.matching.trees), forest_.size()));
  }
}

void LoopDatabase::rebuild() {
  forest_ = make_forest(options_.matching);
  origins_.clear();
  for (std::size_t i = 0; i < descriptions_.size(); ++i) {
    insert_features(static_cast<std::uint32_t>(i));
  }
}

void LoopDatabase::remove_session(int session) {
  std::erase_if(descriptions_, [&](const MapDescription& d) { return d.key.session == session; });
  rebuild();
}

bool LoopDatabase::is_candidate(const MapKey& reference, const MapKey& query) const {
  return reference.session != query.session ||
         reference.map < query.map - options_.matching.skipped_maps;
}

std::vector<std::vector<KeypointMatch>> LoopDatabase::match(const MapDescription& query) const {
  std::vector<std::vector<KeypointMatch>> matches = all_matches(query);
  if (options_.matching.nearest_only) {
    for (std::vector<KeypointMatch>& of_map : matches) keep_nearest(of_map);
  }
  return matches;
}

std::vector<std::vector<KeypointMatch>> LoopDatabase::all_matches(
    const MapDescription& query) const {
  std::vector<std::vector<KeypointMatch>> matches(descriptions_.size());
  const int bound = options_.matching.max_distance_bits;
  if (options_.matching.method == "exhaustive") {
    std::vector<std::uint16_t> distances;
    for (std::size_t m = 0; m < descriptions_.size(); ++m) {
      if (!is_candidate(descriptions_[m].key, query.key)) continue;
      const std::vector<Descriptor>& stored = descriptions_[m].descriptors;
      distances.resize(stored.size());
      for (std::uint32_t q = 0; q < query.descriptors.size(); ++q) {
        hamming_distances(query.descriptors[q], stored.data(), stored.size(), distances.data());
        for (std::uint32_t r = 0; r < stored.size(); ++r) {
          if (distances[r] <= bound) matches[m].push_back({q, r, distances[r]});
        }
      }
    }
    return matches;
  }
  std::vector<bool> candidate(descriptions_.size());
  for (std::size_t m = 0; m < descriptions_.size(); ++m) {
    candidate[m] = is_candidate(descriptions_[m].key, query.key);
  }
  std::vector<HammingForest::Match> found;
  for (std::uint32_t q = 0; q < query.descriptors.size(); ++q) {
    forest_.search(query.descriptors[q], bound, found);
    for (const HammingForest::Match& f : found) {
      const Origin& origin = origins_[f.id];
      if (candidate[origin.description]) {
        matches[origin.description].push_back({q, origin.keypoint, f.distance});
      }
    }
  }
  return matches;
}

std::vector<std::size_t> LoopDatabase::most_matched(
    const std::vector<std::vector<KeypointMatch>>& matches, std::size_t least) const {
  std::vector<std::size_t> order;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (matches[m].size() >= least) order.push_back(m);
  }
  const auto limit = static_cast<std::size_t>(options_.matching.max_references);
  if (order.size() > limit) {
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return matches[a].size() != matches[b].size() ? matches[a].size() > matches[b].size()
                                                    : descriptions_[a].key < descriptions_[b].key;
    });
    order.resize(limit);
  }
  return order;
}

std::vector<ClosureCandidate> LoopDatabase::query(const MapDescription& query,
                                                  LoopClosureTimes* times) const {
  Stopwatch watch;
  const std::vector<std::vector<KeypointMatch>> matches = match(query);
  const double matching = watch.lap();
  const auto least = static_cast<std::size_t>(options_.consensus.min_inliers);
  std::vector<ClosureCandidate> candidates;
  const Pose T_query_ground = query.T_ground_map.inverse();
  for (const std::size_t m : most_matched(matches, least)) {
    const MapDescription& reference = descriptions_[m];
    const Consensus consensus = find_consensus(query, reference, matches[m], options_.consensus,
                                               seed_of(reference.key, query.key));
    if (consensus.inliers.size() < least) continue;
    ClosureCandidate candidate;
    candidate.reference = reference.key;
    candidate.query = query.key;
    candidate.matches = static_cast<int>(matches[m].size());
    candidate.inliers = static_cast<int>(consensus.inliers.size());
    candidate.T_query_reference =
        T_query_ground * lift(consensus.T_query_reference) * reference.T_ground_map;
    candidates.push_back(candidate);
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const ClosureCandidate& a, const ClosureCandidate& b) {
              return a.reference < b.reference;
            });
  if (times != nullptr) {
    times->matching += matching;
    times->consensus += watch.lap();
  }
  return candidates;
}

}  // namespace groundloop
