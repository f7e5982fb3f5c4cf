#include "tests/benchmarks/baselines/triangles.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "frontend/core/parallel.hpp"

namespace groundloop::baselines {
namespace {

constexpr double kSuppression = 2.0;                // m
constexpr std::size_t kNeighbours = 10;             // the point itself among them
constexpr double kShortest = 2.0, kLongest = 50.0;  // m
constexpr double kSidesAMetre = 5.0;                // a side counts in fifths of a metre
constexpr double kAlikeSides = 0.01;                // of their norm
constexpr std::size_t kCandidates = 50, kLeastVotes = 5, kLeastInliers = 4;
constexpr double kCornersApart = 3.0;  // m
constexpr std::size_t kScansAFrame = 10;
constexpr double kDownsampling = 0.25;  // m

struct Motion {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

// The rigid motion that brings one triangle onto another.
Motion motion(const Triangle& from, const Triangle& to) {
  Eigen::Vector3d centre_from = Eigen::Vector3d::Zero(), centre_to = centre_from;
  for (std::size_t i = 0; i < 3; ++i) {
    centre_from += from.corners[i].position / 3;
    centre_to += to.corners[i].position / 3;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    covariance +=
        (from.corners[i].position - centre_from) * (to.corners[i].position - centre_to).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, 1);
  if ((svd.matrixV() * svd.matrixU().transpose()).determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d R = svd.matrixV() * signs.asDiagonal() * svd.matrixU().transpose();
  return {R, centre_to - R * centre_from};
}

bool agree(const Triangle& from, const Triangle& to, const Motion& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d moved = m.rotation * from.corners[i].position + m.translation;
    if ((moved - to.corners[i].position).norm() >= kCornersApart) return false;
  }
  return true;
}

// Clouds lie across the borders of local maps. A closure is one of those scans that meet in it: of
// each scan of the query and the one of the reference that it lies nearest to, as it was found.
void add_scans_that_meet(const SessionScans& references, const Frame& reference,
                         const SessionScans& queries, const Frame& query,
                         const Pose& T_reference_query, double score, MapPairs& pairs) {
  for (std::size_t i = query.first_scan; i <= query.last_scan; ++i) {
    const Eigen::Vector3d at = T_reference_query * queries.T_world_scan(i).translation;
    std::size_t nearest = reference.first_scan;
    for (std::size_t j = reference.first_scan; j <= reference.last_scan; ++j) {
      if ((references.T_world_scan(j).translation - at).norm() <
          (references.T_world_scan(nearest).translation - at).norm()) {
        nearest = j;
      }
    }
    if (!may_report(references, nearest, queries, i)) continue;
    pairs.add(references, nearest, queries, i, score,
              queries.T_world_scan(i).inverse() * T_reference_query.inverse() *
                  references.T_world_scan(nearest));
  }
}

}  // namespace

std::vector<KeyPoint> strongest(const std::vector<KeyPoint>& points, std::size_t most) {
  std::vector<KeyPoint> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool beaten = std::any_of(points.begin(), points.end(), [&](const KeyPoint& other) {
      return &other != &points[i] && other.strength >= points[i].strength &&
             (other.position - points[i].position).norm() < kSuppression;
    });
    if (!beaten) kept.push_back(points[i]);
  }
  if (kept.size() > most) {
    std::stable_sort(kept.begin(), kept.end(),
                     [](const KeyPoint& a, const KeyPoint& b) { return a.strength > b.strength; });
    kept.resize(most);
  }
  return kept;
}

std::vector<Triangle> triangles(const std::vector<KeyPoint>& points, double least_height) {
  std::vector<Triangle> result;
  std::set<std::array<long, 3>> known;  // sides in mm: each triangle is met from several corners
  for (const KeyPoint& point : points) {
    std::vector<std::pair<double, const KeyPoint*>> nearest;
    for (const KeyPoint& other : points) {
      nearest.emplace_back((other.position - point.position).norm(), &other);
    }
    const std::size_t count = std::min(kNeighbours, nearest.size());
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count),
                      nearest.end());
    for (std::size_t m = 1; m < count; ++m) {
      for (std::size_t n = m + 1; n < count; ++n) {
        // A side and the corner that it does not touch.
        struct Side {
          double length;
          const KeyPoint* opposite;
        };
        const KeyPoint *p = &point, *q = nearest[m].second, *r = nearest[n].second;
        std::array<Side, 3> sides{{{(p->position - q->position).norm(), r},
                                   {(p->position - r->position).norm(), q},
                                   {(q->position - r->position).norm(), p}}};
        std::stable_sort(sides.begin(), sides.end(),
                         [](const Side& a, const Side& b) { return a.length < b.length; });
        if (sides[0].length < kShortest || sides[2].length > kLongest) continue;
        if (sides[0].length + sides[1].length - sides[2].length < least_height) continue;
        const std::array<long, 3> key{static_cast<long>(1000 * sides[0].length),
                                      static_cast<long>(1000 * sides[1].length),
                                      static_cast<long>(1000 * sides[2].length)};
        if (!known.insert(key).second) continue;
        Triangle t;
        // A lies between the two shorter sides, B between the shortest and the longest.
        t.corners = {*sides[2].opposite, *sides[1].opposite, *sides[0].opposite};
        t.sides = kSidesAMetre * Eigen::Vector3d(sides[0].length, sides[1].length, sides[2].length);
        result.push_back(t);
      }
    }
  }
  return result;
}

void TriangleDatabase::insert(Frame frame) {
  const auto number = static_cast<std::uint32_t>(frames_.size());
  for (std::uint32_t t = 0; t < frame.triangles.size(); ++t) {
    frame.triangles[t].frame = number;
    const Eigen::Vector3d& s = frame.triangles[t].sides;
    cells_[{static_cast<int>(s(0) + 0.5), static_cast<int>(s(1) + 0.5),
            static_cast<int>(s(2) + 0.5)}]
        .emplace_back(number, t);
  }
  frames_.push_back(std::move(frame));
}

std::vector<FrameMatch> TriangleDatabase::search(
    const Frame& query, const std::function<bool(const Frame&)>& eligible) const {
  std::vector<bool> may(frames_.size());
  for (std::size_t f = 0; f < frames_.size(); ++f) may[f] = eligible(frames_[f]);
  std::map<std::uint32_t, std::vector<Match>> by_frame;
  for (const Triangle& t : query.triangles) {
    const double bound = kAlikeSides * t.sides.norm();
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          const std::array<int, 3> at{static_cast<int>(t.sides(0)) + x,
                                      static_cast<int>(t.sides(1)) + y,
                                      static_cast<int>(t.sides(2)) + z};
          const Eigen::Vector3d middle(at[0] + 0.5, at[1] + 0.5, at[2] + 0.5);
          if ((t.sides - middle).norm() >= 1.5) continue;
          const auto cell = cells_.find(at);
          if (cell == cells_.end()) continue;
          for (const auto& [frame, index] : cell->second) {
            const Triangle& other = frames_[frame].triangles[index];
            if (!may[frame] || (t.sides - other.sides).norm() >= bound) continue;
            if (alike_(t, other)) by_frame[frame].emplace_back(&t, &other);
          }
        }
      }
    }
  }
  std::vector<std::pair<std::size_t, std::uint32_t>> votes;
  for (const auto& [frame, matches] : by_frame) {
    if (matches.size() >= kLeastVotes) votes.emplace_back(matches.size(), frame);
  }
  std::stable_sort(votes.begin(), votes.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  if (votes.size() > kCandidates) votes.resize(kCandidates);
  std::vector<FrameMatch> found;
  for (const auto& [count, frame] : votes) {
    if (const auto match = verify(query, frame, by_frame.at(frame))) found.push_back(*match);
  }
  return found;
}

std::optional<FrameMatch> TriangleDatabase::verify(const Frame& query, std::uint32_t frame,
                                                   const std::vector<Match>& matches) const {
  // About fifty of the matches are tried as motions.
  const std::size_t step = matches.size() / 50 + 1;
  std::size_t most = 0;
  Motion best{};
  for (std::size_t i = 0; i + step <= matches.size(); i += step) {
    const Motion m = motion(*matches[i].first, *matches[i].second);
    const auto count = static_cast<std::size_t>(
        std::count_if(matches.begin(), matches.end(),
                      [&](const Match& match) { return agree(*match.first, *match.second, m); }));
    if (count > most) most = count, best = m;
  }
  if (most < kLeastInliers) return std::nullopt;
  return FrameMatch{
      frame, plane_agreement(query.planes, frames_[frame].planes, best.rotation, best.translation),
      best.rotation, best.translation};
}

MapPairs detect_by_triangles(
    const SessionScans& references, const SessionScans& queries,
    const std::function<std::vector<Triangle>(const std::vector<Eigen::Vector3d>&,
                                              const PlaneVoxels&)>& describe,
    const AlikeTriangles& alike) {
  const auto frames_of = [&](const SessionScans& scans) {
    std::vector<Frame> frames((scans.size() + kScansAFrame - 1) / kScansAFrame);
    parallel_for(frames.size(), 1, [&](std::size_t f) {
      Frame& frame = frames[f];
      frame.first_scan = f * kScansAFrame;
      frame.last_scan = std::min(scans.size(), frame.first_scan + kScansAFrame) - 1;
      std::vector<Eigen::Vector3d> cloud;
      for (std::size_t i = frame.first_scan; i <= frame.last_scan; ++i) {
        for (const Eigen::Vector3f& p : voxel_means(scans.points(i), kDownsampling)) {
          cloud.push_back(scans.T_world_scan(i) * p.cast<double>().eval());
        }
      }
      const PlaneVoxels voxels = plane_voxels(cloud);
      frame.planes = planes_of(voxels);
      frame.triangles = describe(cloud, voxels);
    });
    return frames;
  };
  TriangleDatabase database(alike);
  for (Frame& frame : frames_of(references)) database.insert(std::move(frame));
  const bool same = &references == &queries;
  const std::vector<Frame> other = same ? std::vector<Frame>() : frames_of(queries);
  const std::vector<Frame>& query = same ? database.frames() : other;
  std::vector<std::vector<FrameMatch>> found(query.size());
  parallel_for(query.size(), 1, [&](std::size_t q) {
    found[q] = database.search(query[q], [&](const Frame& reference) {
      return may_report(references, reference.first_scan, queries, query[q].last_scan);
    });
  });
  MapPairs pairs;
  for (std::size_t q = 0; q < query.size(); ++q) {
    for (const FrameMatch& match : found[q]) {
      const Frame& reference = database.frames()[match.frame];
      const Pose T_reference_query(match.rotation, match.translation);  // between the worlds
      add_scans_that_meet(references, reference, queries, query[q], T_reference_query, match.score,
                          pairs);
    }
  }
  return pairs;
}

}  // namespace groundloop::baselines
