// The loop database (Sec. 3.5): descriptions of local maps of one or several sessions, searched for
// those that may show the same place as a query. In memory and on disk. It proposes candidates; it
// does not decide whether they are true.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "loopclosure/consensus.hpp"
#include "loopclosure/hamming_forest.hpp"
#include "loopclosure/loop_closure.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

class LoopDatabase {
 public:
  explicit LoopDatabase(const LoopClosureOptions& options);

  /// Adds a map; its key must be new. Its features enter the forest.
  void insert(MapDescription description);

  /// Candidates for `query`, sorted by the reference's key: every map of another session, and of
  /// the query's own session those before it but for the last options.matching.skipped_maps, that
  /// have at least options.consensus.min_inliers inliers. The query itself is not inserted.
  [[nodiscard]] std::vector<ClosureCandidate> query(const MapDescription& query,
                                                    LoopClosureTimes* times = nullptr) const;

  /// Matches of a query's features, one list a description in their order; empty for maps that are
  /// no candidates.
  [[nodiscard]] std::vector<std::vector<KeypointMatch>> match(const MapDescription& query) const;

  /// In the order they were inserted.
  [[nodiscard]] const std::vector<MapDescription>& descriptions() const { return descriptions_; }

  /// Removes all maps of a session.
  void remove_session(int session);

  /// The descriptions, versioned and with a checksum; the forest follows from them.
  [[nodiscard]] std::vector<std::byte> bytes() const;
  void save(const std::filesystem::path& file) const;
  /// Throws InputError, naming the file, where it is no loop database, of another version, damaged,
  /// or holds what no map can have.
  [[nodiscard]] static LoopDatabase load(const std::filesystem::path& file,
                                         const LoopClosureOptions& options);
  /// The same from memory; `name` is what errors call it.
  [[nodiscard]] static LoopDatabase from_bytes(std::span<const std::byte> bytes,
                                               const std::string& name,
                                               const LoopClosureOptions& options);

 private:
  [[nodiscard]] std::vector<std::vector<KeypointMatch>> all_matches(
      const MapDescription& query) const;
  [[nodiscard]] bool is_candidate(const MapKey& reference, const MapKey& query) const;
  /// Descriptions with at least `least` matches; where there are too many, those with the most.
  [[nodiscard]] std::vector<std::size_t> most_matched(
      const std::vector<std::vector<KeypointMatch>>& matches, std::size_t least) const;
  void insert_features(std::uint32_t index);
  void rebuild();

  LoopClosureOptions options_;
  std::vector<MapDescription> descriptions_;
  HammingForest forest_;
  /// For each feature in the forest: its description and its place there.
  struct Origin {
    std::uint32_t description, keypoint;
  };
  std::vector<Origin> origins_;
};

}  // namespace groundloop
