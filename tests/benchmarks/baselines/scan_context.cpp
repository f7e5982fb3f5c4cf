#include "tests/benchmarks/baselines/scan_context.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frontend/core/parallel.hpp"

namespace groundloop::baselines {
namespace {

constexpr double kMaxRadius = 80.0;    // m
constexpr double kSensorHeight = 2.0;  // m
constexpr std::size_t kCandidates = 10;

std::vector<ScanContext> contexts(const SessionScans& scans) {
  std::vector<ScanContext> result(scans.size());
  parallel_for(scans.size(), 8, [&](std::size_t i) { result[i] = scan_context(scans.points(i)); });
  return result;
}

}  // namespace

ScanContext scan_context(const Points& points) {
  ScanContext context = ScanContext::Zero();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>();
    const double radius = std::hypot(p.x(), p.y());
    if (!(radius < kMaxRadius)) continue;
    double angle = std::atan2(p.y(), p.x());
    if (angle < 0) angle += 2 * std::numbers::pi;
    const int ring = static_cast<int>(radius / kMaxRadius * kRings);
    const int sector =
        std::min(kSectors - 1, static_cast<int>(angle / (2 * std::numbers::pi) * kSectors));
    context(ring, sector) = std::max(context(ring, sector), p.z() + kSensorHeight);
  }
  return context;
}

RingKey ring_key(const ScanContext& context) { return context.rowwise().mean(); }

double scan_context_distance(const ScanContext& a, const ScanContext& b) {
  const Eigen::RowVectorXd norm_a = a.colwise().norm(), norm_b = b.colwise().norm();
  const Eigen::MatrixXd products = a.transpose() * b;  // sectors of a by sectors of b
  double best = 1.0;
  for (int turn = 0; turn < kSectors; ++turn) {
    double sum = 0.0;
    int count = 0;
    for (int s = 0; s < kSectors; ++s) {
      const int t = (s + turn) % kSectors;
      if (norm_a(s) == 0 || norm_b(t) == 0) continue;
      sum += products(s, t) / (norm_a(s) * norm_b(t));
      ++count;
    }
    if (count > 0) best = std::min(best, 1.0 - sum / count);
  }
  return best;
}

MapPairs detect_by_scan_context(const SessionScans& references, const SessionScans& queries) {
  const std::vector<ScanContext> reference = contexts(references);
  const bool same = &references == &queries;
  const std::vector<ScanContext> other = same ? std::vector<ScanContext>() : contexts(queries);
  const std::vector<ScanContext>& query = same ? reference : other;
  std::vector<RingKey> keys;
  for (const ScanContext& context : reference) keys.push_back(ring_key(context));
  struct Found {
    std::size_t reference;
    double distance;
  };
  std::vector<std::vector<Found>> found(query.size());
  parallel_for(query.size(), 8, [&](std::size_t q) {
    const RingKey key = ring_key(query[q]);
    std::vector<std::pair<double, std::size_t>> nearest;
    for (std::size_t r = 0; r < reference.size(); ++r) {
      if (may_report(references, r, queries, q)) nearest.emplace_back((keys[r] - key).norm(), r);
    }
    const std::size_t count = std::min(kCandidates, nearest.size());
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count),
                      nearest.end());
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t r = nearest[i].second;
      found[q].push_back({r, scan_context_distance(query[q], reference[r])});
    }
  });
  MapPairs pairs;
  for (std::size_t q = 0; q < query.size(); ++q) {
    for (const Found& f : found[q]) {
      pairs.add(references, f.reference, queries, q, 1.0 - f.distance, std::nullopt);
    }
  }
  return pairs;
}

}  // namespace groundloop::baselines
