// Reference closures (Sec. 4.3 of the paper): pairs of local maps, rebuilt from the raw scans at
// ground-truth poses, that share enough of their voxels. Overlaps are computed once for all that is
// judged against them; the threshold comes later.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frontend/core/options.hpp"
#include "frontend/core/progress.hpp"
#include "loopclosure/evaluation/evaluated_map.hpp"

namespace groundloop {

struct ReferenceOptions {
  double overlap = 0.25;
  double overlap_between_sessions = 0.10;
  double uncertain_share = 0.2;
  int skipped_maps = 3;
  bool align = false;
  std::string pairs = "all";

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("overlap", self.overlap, Range{0.0, 1.0}, "", "of a reference closure, exceeded");
    field("overlap_between_sessions", self.overlap_between_sessions, Range{0.0, 1.0}, "",
          "the same between sessions");
    field("uncertain_share", self.uncertain_share, Range{0.0, 1.0}, "",
          "of the threshold: a pair whose overlap is as near to it is called uncertain");
    field("skipped_maps", self.skipped_maps, Range{0, 1000000}, "",
          "maps just before the query that are no reference closures");
    field("align", self.align, OnOff{}, "",
          "ICP between reference maps first, where ground truth differs between visits");
    field("pairs", self.pairs, Choices{"all", "within", "between"}, "",
          "of maps of one session, of two, or all");
  }
};

/// How the way of the query runs where it meets that of the reference.
enum class TravelDirection { same, opposite, crossing, apart };
[[nodiscard]] const char* to_string(TravelDirection direction);

/// Two maps that share voxels, threshold or not.
struct PairOverlap {
  MapKey reference, query;
  double overlap = 0.0;  ///< shared 0.5 m voxels, in the query map's frame, over the smaller map's
  TravelDirection direction = TravelDirection::apart;
  double distance = 0.0;  ///< m between the two ways where they meet (median)
};

/// Whether a pair may be reported at all: of two sessions the reference's comes first, within one
/// the reference is older than the skipped maps before the query.
[[nodiscard]] bool is_eligible(const MapKey& reference, const MapKey& query,
                               const ReferenceOptions& options);

/// Eligible pairs of known maps.
[[nodiscard]] std::size_t count_eligible(const std::vector<EvaluatedMap>& maps,
                                         const ReferenceOptions& options);

/// Eligible pairs that share more than a hundredth, in the order of their queries, then their
/// references. Maps without ground truth have none.
[[nodiscard]] std::vector<PairOverlap> overlapping_pairs(const std::vector<EvaluatedMap>& maps,
                                                         const ReferenceOptions& options,
                                                         const Progress& progress = {});

/// The threshold that a pair must exceed.
[[nodiscard]] double overlap_threshold(const MapKey& reference, const MapKey& query,
                                       const ReferenceOptions& options);
[[nodiscard]] bool is_reference(const PairOverlap& pair, const ReferenceOptions& options);
/// Too near to the threshold to say.
[[nodiscard]] bool is_uncertain(const PairOverlap& pair, const ReferenceOptions& options);

}  // namespace groundloop
