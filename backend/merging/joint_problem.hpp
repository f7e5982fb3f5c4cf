// The recordings of a merge as one pose graph while connections between them are being decided:
// numbering, access to local maps, solving, and the trial of a pair of maps.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backend/merging/session_merge.hpp"
#include "backend/registration/ground_footprint.hpp"
#include "backend/session/map_store.hpp"

namespace groundloop {

class JointProblem {
 public:
  JointProblem(const std::vector<StoredSession>& sessions, std::optional<std::size_t> fixed,
               const MergeOptions& options);

  std::vector<MergedPart> parts;
  /// Ids are positions: part.first_map + map. The sessions' own edges come first; their closures
  /// were judged by their sessions and are settled.
  PoseGraph graph;
  std::vector<int> part_of;             ///< of each vertex
  std::vector<ClosureRecord> closures;  ///< between recordings of different frames at the start
  std::vector<std::string> notes;

  [[nodiscard]] int vertex(int part, int map) const { return parts[part].first_map + map; }
  [[nodiscard]] int query_vertex(const ClosureRecord& closure) const;
  [[nodiscard]] int reference_vertex(const ClosureRecord& closure) const;
  [[nodiscard]] int frame_of(int vertex) const { return parts[part_of[vertex]].frame; }
  /// "a", or "a with b and c": what moves together with the recording that names the frame.
  [[nodiscard]] std::string frame_name(int frame) const;
  [[nodiscard]] MapStore& store(int part) { return *stores_[parts[part].session]; }
  [[nodiscard]] std::shared_ptr<StoredMap> map(int vertex);
  [[nodiscard]] const GroundFootprint& footprint(int vertex);

  /// The closure as an edge between vertices, the maps' first scans: as it is where the maps meet,
  /// and along the sessions' own solutions, which bent the maps' odometry, from there.
  [[nodiscard]] GraphEdge edge_of(const ClosureRecord& closure) const;
  /// Share of the smaller map's ground that two maps have in common at the poses of `poses`.
  [[nodiscard]] double predicted_overlap(const PoseGraph& poses, int reference, int query);
  /// Registers two maps from the poses of `poses`; nothing where it fails or leads far away.
  [[nodiscard]] std::optional<ClosureRecord> try_pair(const PoseGraph& poses, int a, int b);
  /// Whether a closure of the same maps and, to 0.3 m and 0.3 degrees, the same pose is there: the
  /// detector and the overlap of maps may lead to the same one, which must count once.
  [[nodiscard]] bool knows(const ClosureRecord& closure) const;
  /// Optimises `graph`, holding the frames that are not `active`, the fixed recordings and the
  /// first map of each active frame without one.
  OptimizationSummary solve(PoseGraph& problem, const std::vector<int>& active, bool robust,
                            const Progress& progress);

 private:
  const MergeOptions& options_;
  std::vector<std::unique_ptr<MapStore>> stores_;
  std::vector<std::optional<GroundFootprint>> footprints_;
};

}  // namespace groundloop
