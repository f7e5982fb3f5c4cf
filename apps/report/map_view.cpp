#include "apps/report/map_view.hpp"

#include <algorithm>
#include <functional>

#include "apps/report/surface_thickness.hpp"
#include "backend/map/map_piece.hpp"
#include "frontend/core/parallel.hpp"
#include "frontend/core/pcd.hpp"

namespace groundloop::apps {
namespace {

// A local map in the frame of its strand. A map that a loss cut in two belongs to the strand of its
// first scan.
struct PlacedMap {
  MapPiece piece;
  std::size_t strand = 0;
  Pose T_world_map_by_odometry;
  std::uint64_t points = 0;
};

std::vector<PlacedMap> maps_of_frame(const SessionContents& contents, int frame) {
  std::vector<PlacedMap> maps;
  for (std::size_t p = 0; p < contents.session.parts.size(); ++p) {
    const SessionPart& part = contents.session.parts[p];
    for (const LocalMapRecord& map : part.maps) {
      const StrandScan at = strand_of(contents, p, map.first_scan);
      const Strand& strand = contents.strands[at.strand];
      if (strand.frame != frame) continue;
      const std::filesystem::path file =
          contents.session.folder.local_map(part.first_map + map.map);
      const Pose placed =
          part.trajectory[strand.first_scan].pose * part.odometry[strand.first_scan].pose.inverse();
      maps.push_back({bent_piece(file, map, part.odometry, part.trajectory), at.strand,
                      placed * part.odometry[map.first_scan].pose, map.points});
    }
  }
  return maps;
}

// A point in the solution and by odometry, and its row.
struct PlacedPoint {
  MapPoint optimised;
  Eigen::Vector3f odometry;
};

class FrameReader {
 public:
  FrameReader(const SessionContents& contents, const ScanTable& table, int frame)
      : contents_(contents), table_(table), maps_(maps_of_frame(contents, frame)) {
    // Of very large maps every n-th point is enough for a picture of them.
    constexpr std::uint64_t kEnough = 30'000'000;
    std::uint64_t all = 0;
    for (const PlacedMap& map : maps_) all += map.points;
    step_ = static_cast<std::size_t>(1 + all / kEnough);
  }

  void for_each(const std::function<void(const PlacedPoint&)>& f) const {
    for (const PlacedMap& map : maps_) {
      for (const PlacedPoint& point : placed(map)) f(point);
    }
  }

 private:
  [[nodiscard]] std::vector<PlacedPoint> placed(const PlacedMap& map) const {
    const Points points = read_pcd(map.piece.file);
    const Strand& strand = contents_.strands[map.strand];
    PlacementIndex index(map.piece);
    std::vector<const ScanPlacement*> nearest;
    for (std::size_t i = 0; i < points.size(); i += step_)
      nearest.push_back(&index.nearest(points[i]));
    std::vector<PlacedPoint> result(nearest.size());
    parallel_for(result.size(), 16384, [&](std::size_t i) {
      const Eigen::Vector3d p = points[i * step_].cast<double>();
      const std::size_t scan = std::max(nearest[i]->scan, strand.first_scan) - strand.first_scan;
      result[i].optimised.position = (nearest[i]->T_world_map * p).cast<float>();
      result[i].optimised.row =
          static_cast<std::uint32_t>(table_.row_of(map.strand, std::min(scan, strand.scans - 1)));
      result[i].odometry = (map.T_world_map_by_odometry * p).cast<float>();
    });
    return result;
  }

  const SessionContents& contents_;
  const ScanTable& table_;
  std::vector<PlacedMap> maps_;
  std::size_t step_ = 1;
};

std::vector<Eigen::Vector3d> positions_of_frame(const SessionContents& contents,
                                                const ScanTable& table, int frame) {
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t s = 0; s < table.spans.size(); ++s) {
    if (contents.strands[s].frame != frame) continue;
    const RowSpan& span = table.spans[s];
    for (std::size_t row = span.first_row; row < span.first_row + span.rows; ++row) {
      positions.push_back(table.optimised[row].translation);
      positions.push_back(table.odometry[row].translation);
    }
  }
  return positions;
}

FrameView view_frame(const SessionContents& contents, const ScanTable& table, int frame,
                     std::size_t most_points) {
  FrameView view;
  view.window = window_around(positions_of_frame(contents, table, frame));
  const FrameReader reader(contents, table, frame);
  TopView optimised(view.window);
  TopView odometry(view.window);
  PointSampler sampler(most_points);
  reader.for_each([&](const PlacedPoint& point) {
    optimised.add(point.optimised.position);
    odometry.add(point.odometry);
    if (most_points > 0) sampler.add(point.optimised);
  });
  view.optimised = optimised.draw();
  view.odometry = odometry.draw();
  if (most_points == 0) return view;
  const float spacing = sampler.voxel_size();
  view.octree = build_octree(sampler.take(), spacing, most_points);
  SurfaceThickness thickness;
  for (const MapPoint& point : view.octree.points) thickness.ask(point.position);
  reader.for_each([&](const PlacedPoint& point) { thickness.add(point.optimised.position); });
  view.thickness.resize(view.octree.points.size());
  parallel_for(view.thickness.size(), 4096, [&](std::size_t i) {
    view.thickness[i] = thickness.at(view.octree.points[i].position);
  });
  return view;
}

}  // namespace

std::vector<FrameView> make_map_views(const SessionContents& contents, const ScanTable& table,
                                      std::size_t most_points) {
  std::vector<FrameView> views;
  for (std::size_t f = 0; f < contents.frame_names.size(); ++f) {
    std::size_t rows = 0;
    for (std::size_t s = 0; s < table.spans.size(); ++s) {
      if (contents.strands[s].frame == static_cast<int>(f)) rows += table.spans[s].rows;
    }
    const std::size_t share = most_points * rows / std::max<std::size_t>(1, table.rows());
    views.push_back(view_frame(contents, table, static_cast<int>(f), share));
  }
  return views;
}

}  // namespace groundloop::apps
