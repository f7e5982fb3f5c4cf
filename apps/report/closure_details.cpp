#include "apps/report/closure_details.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "apps/report/closure_matches.hpp"
#include "apps/report/grey_picture.hpp"
#include "apps/report/point_sampler.hpp"
#include "backend/registration/column_agreement.hpp"
#include "backend/session/map_store.hpp"
#include "loopclosure/density_image.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

// How much there is to see of a closure: most first.
int interest(const ClosureRecord& c) {
  switch (c.status) {
    case ClosureStatus::accepted:
      return 0;
    case ClosureStatus::outlier:
    case ClosureStatus::inconsistent:
      return 1;
    case ClosureStatus::low_overlap:
    case ClosureStatus::icp_diverged:
      return 2;
    case ClosureStatus::few_inliers:
      return 3;
  }
  return 3;
}

// Of more accepted closures than there is room for, a spread over the way.
std::vector<std::size_t> choose(const std::vector<ClosureRecord>& closures, std::size_t most) {
  std::vector<std::size_t> accepted;
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < closures.size(); ++i)
    (interest(closures[i]) == 0 ? accepted : others).push_back(i);
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(accepted.size(), most);
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(accepted[k * accepted.size() / count]);
  std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
    const int ia = interest(closures[a]);
    const int ib = interest(closures[b]);
    return ia != ib ? ia < ib : closures[a].inliers > closures[b].inliers;
  });
  for (const std::size_t i : others) {
    if (chosen.size() < most) chosen.push_back(i);
  }
  return chosen;
}

Json to_json(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

// Dark is much, as on paper; the square root lifts low walls, which are most of an image.
GreyPicture to_picture(const DensityImage& image) {
  GreyPicture picture{image.width, image.height, {}};
  picture.pixels.reserve(image.pixels.size());
  for (int v = image.height - 1; v >= 0; --v) {
    for (int u = 0; u < image.width; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
                            static_cast<std::size_t>(u);
      const double ink = std::sqrt(image.pixels[i] / 255.0);
      picture.pixels.push_back(
          static_cast<std::uint8_t>(std::lround(255.0 - 15.0 * std::round(17.0 * ink))));
    }
  }
  return picture;
}

std::string data_uri(const GreyPicture& picture) {
  return "data:image/png;base64," + base64(to_png(picture));
}

// Keypoints are in ground-frame metres.
Json map_json(const Points& points, const MapDescription& description,
              const DensityImageOptions& options, Blobs& blobs) {
  const DensityImage image = make_density_image(points, description.T_ground_map, options);
  std::vector<float> keypoints;
  for (const Eigen::Vector2f& k : description.keypoints)
    keypoints.insert(keypoints.end(), {k.x(), k.y()});
  Json json{
      {"width", image.width},
      {"height", image.height},
      {"low", {image.first_cell.x() * image.resolution, image.first_cell.y() * image.resolution}},
      {"pixel", image.resolution},
      {"ground_quality", description.ground_quality},
      {"keypoints", blobs.add(std::span<const float>(keypoints))}};
  json["picture"] = image.pixels.empty() ? std::string() : data_uri(to_picture(image));
  return json;
}

// Points of a map within `radius` of `centre`, in its ground frame and relative to the centre, in
// centimetres above -32768: x of all, y of all, z of all.
std::vector<std::uint16_t> around(const Points& points, const Pose& T_ground_map,
                                  const Eigen::Vector3d& centre,
                                  const ClosureDetailLimits& limits) {
  PointSampler sampler(limits.points / 2);
  const PoseF T(Pose(Eigen::Quaterniond::Identity(), -centre) * T_ground_map);
  const auto radius = static_cast<float>(limits.radius);
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = T * point;
    if (p.head<2>().squaredNorm() < radius * radius && std::abs(p.z()) < 300.0F)
      sampler.add({p, 0});
  }
  std::vector<std::uint16_t> planes;
  for (int axis = 0; axis < 3; ++axis) {
    for (const MapPoint& p : sampler.points())
      planes.push_back(static_cast<std::uint16_t>(std::lround(100.0F * p.position[axis]) + 32768));
  }
  return planes;
}

class Details {
 public:
  Details(const SessionContents& contents, Blobs& blobs, const ClosureDetailLimits& limits)
      : contents_(contents),
        blobs_(blobs),
        limits_(limits),
        store_(contents.session.folder, contents.config.slam.registration, 8),
        start_(blobs.bytes()) {}

  [[nodiscard]] bool full() const {
    return blobs_.bytes() - start_ + picture_bytes_ >= limits_.bytes;
  }

  void add(const ClosureRow& row, const ShownMatches& matches) {
    const ClosureRecord& c = contents_.session.closures[row.closure];
    const MapDescription& r = description(row.reference_part, c.reference_map);
    const MapDescription& q = description(row.query_part, c.query_map);
    const std::shared_ptr<StoredMap> query = show(row.query_part, c.query_map);
    const std::shared_ptr<StoredMap> reference = show(row.reference_part, c.reference_map);
    const Pose T_initial = q.T_ground_map * c.initial_T_query_reference * r.T_ground_map.inverse();
    const Pose T_refined = q.T_ground_map * c.T_query_reference * r.T_ground_map.inverse();
    Json json{{"reference", id(row.reference_part, c.reference_map)},
              {"query", id(row.query_part, c.query_map)},
              {"initial", to_json(T_initial)},
              {"refined", to_json(T_refined)}};
    std::vector<std::uint16_t> pairs;
    for (std::size_t m = 0; m < matches.matches.size(); ++m) {
      pairs.push_back(static_cast<std::uint16_t>(matches.matches[m].query));
      pairs.push_back(static_cast<std::uint16_t>(matches.matches[m].reference));
      pairs.push_back(matches.inlier[m] ? 1 : 0);
    }
    json["matches"] = blobs_.add(std::span<const std::uint16_t>(pairs));
    add_points(row, c, q, r, query->points(), reference->points(), T_refined, json);
    if (c.overlap) {
      const ColumnGrid columns(reference->points(), c.T_query_reference, query->target().up());
      const ColumnAgreement agreement = query->target().columns().agreement(columns);
      if (agreement.defined) json["agreement"] = agreement.correlation;
    }
    closures_[std::to_string(row.closure)] = std::move(json);
  }

  [[nodiscard]] Json take() {
    return {
        {"radius", limits_.radius}, {"maps", std::move(maps_)}, {"closures", std::move(closures_)}};
  }

 private:
  [[nodiscard]] int number(std::size_t part, int map) const {
    return contents_.session.parts[part].first_map + map;
  }
  [[nodiscard]] std::string id(std::size_t part, int map) const {
    return std::to_string(number(part, map));
  }
  [[nodiscard]] const MapDescription& description(std::size_t part, int map) const {
    return contents_.session.parts[part].descriptions[static_cast<std::size_t>(map)];
  }

  std::shared_ptr<StoredMap> show(std::size_t part, int map) {
    std::shared_ptr<StoredMap> stored = store_.get(number(part, map));
    if (!maps_.contains(id(part, map))) {
      Json json = map_json(stored->points(), description(part, map),
                           contents_.config.slam.loop_closure.density_image, blobs_);
      picture_bytes_ += json["picture"].get_ref<const std::string&>().size();
      maps_[id(part, map)] = std::move(json);
    }
    return stored;
  }

  // About the scan of the query that met the reference.
  void add_points(const ClosureRow& row, const ClosureRecord& c, const MapDescription& q,
                  const MapDescription& r, const Points& query, const Points& reference,
                  const Pose& T_refined, Json& json) {
    const SessionPart& part = contents_.session.parts[row.query_part];
    const std::size_t first = part.maps[static_cast<std::size_t>(c.query_map)].first_scan;
    const std::size_t scan =
        contents_.strands[row.query_scan.strand].first_scan + row.query_scan.scan;
    const Pose T_map_scan = part.odometry[first].pose.inverse() * part.odometry[scan].pose;
    const Eigen::Vector3d centre = q.T_ground_map * T_map_scan.translation;
    const Eigen::Vector3d reference_centre = T_refined.inverse() * centre;
    json["centre"] = {centre.x(), centre.y(), centre.z()};
    json["reference_centre"] = {reference_centre.x(), reference_centre.y(), reference_centre.z()};
    json["query_points"] =
        blobs_.add(std::span<const std::uint16_t>(around(query, q.T_ground_map, centre, limits_)));
    json["reference_points"] = blobs_.add(std::span<const std::uint16_t>(
        around(reference, r.T_ground_map, reference_centre, limits_)));
  }

  const SessionContents& contents_;
  Blobs& blobs_;
  ClosureDetailLimits limits_;
  MapStore store_;
  std::size_t start_;
  std::size_t picture_bytes_ = 0;
  Json maps_ = Json::object();
  Json closures_ = Json::object();
};

}  // namespace

Json closure_details(const SessionContents& contents, const std::vector<ClosureRow>& rows,
                     Blobs& blobs, const ClosureDetailLimits& limits) {
  const std::vector<std::size_t> chosen = choose(contents.session.closures, limits.closures);
  const std::vector<ShownMatches> matches = find_matches(contents, chosen);
  Details details(contents, blobs, limits);
  for (std::size_t k = 0; k < chosen.size() && !details.full(); ++k)
    details.add(rows[chosen[k]], matches[k]);
  return details.take();
}

}  // namespace groundloop::apps
