#include "backend/mapping/revisit_check.hpp"

#include <algorithm>
#include <chrono>

namespace groundloop {
namespace {

constexpr int kSkipped = 3;  // maps before a query that overlap it anyway
constexpr double kMinShared = 0.2;
// Fewer cells in common space than this are a pair that lies apart.
constexpr std::size_t kMinCells = 300;
constexpr double kApart = 0.5;  // thickness of such a pair, m: that of a missing surface

std::vector<std::pair<int, int>> revisits(std::span<const GroundFootprint> footprints,
                                          const RelativePoses& before, const RelativePoses& after,
                                          int limit) {
  std::vector<std::pair<int, int>> all;
  const auto n = static_cast<int>(footprints.size());
  for (int query = 0; query < n; ++query) {
    for (int reference = 0; reference + kSkipped < query; ++reference) {
      const auto shared = [&](const RelativePoses& poses) {
        return footprint_overlap(footprints[reference], footprints[query], poses(reference, query));
      };
      if (std::max(shared(before), shared(after)) >= kMinShared) all.emplace_back(reference, query);
    }
  }
  const std::size_t count = std::min(all.size(), static_cast<std::size_t>(limit));
  std::vector<std::pair<int, int>> drawn;
  for (std::size_t i = 0; i < count; ++i) drawn.push_back(all[i * all.size() / count]);
  return drawn;
}

// Sums of pairs' figures; entropy of those pairs that share cells both before and after.
struct Sum {
  RevisitQuality quality;
  std::size_t entropies = 0;
};

void add(Sum& sum, const RevisitQuality& pair, bool with_entropy) {
  sum.quality.plane_thickness += pair.cells < kMinCells ? kApart : pair.plane_thickness;
  sum.quality.cells += pair.cells;
  if (!with_entropy) return;
  sum.quality.entropy += pair.entropy;
  sum.quality.entropy_cells += pair.entropy_cells;
  ++sum.entropies;
}

RevisitQuality mean(const Sum& sum, std::size_t pairs) {
  RevisitQuality result = sum.quality;
  result.plane_thickness /= static_cast<double>(std::max<std::size_t>(1, pairs));
  result.entropy /= static_cast<double>(std::max<std::size_t>(1, sum.entropies));
  return result;
}

}  // namespace

MapQuality compare_revisits(std::span<const GroundFootprint> footprints,
                            const RelativePoses& before, const RelativePoses& after,
                            MapStore& store, const MapQualityOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  MapQuality result;
  Sum sum_before;
  Sum sum_after;
  for (const auto& pair : revisits(footprints, before, after, options.pairs)) {
    const int reference = pair.first;
    const int query = pair.second;
    const std::shared_ptr<StoredMap> q = store.get(query);
    const std::shared_ptr<StoredMap> r = store.get(reference);
    const auto quality = [&](const RelativePoses& poses) {
      return revisit_quality(q->target(), q->points(), r->points(), poses(reference, query));
    };
    const RevisitQuality b = quality(before);
    const RevisitQuality a = quality(after);
    const bool with_entropy = std::min(a.entropy_cells, b.entropy_cells) > 0;
    add(sum_before, b, with_entropy);
    add(sum_after, a, with_entropy);
    ++result.pairs;
  }
  result.before = mean(sum_before, result.pairs);
  result.after = mean(sum_after, result.pairs);
  result.worse =
      result.after.plane_thickness > (1.0 + options.max_loss) * result.before.plane_thickness;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace groundloop
