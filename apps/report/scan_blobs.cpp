#include "apps/report/scan_blobs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string_view>

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void append(const Pose& pose, std::vector<float>& values) {
  const Eigen::Vector3f t = pose.translation.cast<float>();
  const Eigen::Quaternionf q = pose.rotation.cast<float>();
  values.insert(values.end(), {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
}

Json pose_blob(const std::vector<Pose>& poses, Blobs& blobs) {
  std::vector<float> values;
  for (const Pose& pose : poses) append(pose, values);
  return blobs.add(std::span<const float>(values));
}

// Three numbers and an angle a row.
Json error_blob(const std::vector<Eigen::Vector3d>& metres, const std::vector<double>& degrees,
                Blobs& blobs) {
  std::vector<float> values;
  for (std::size_t row = 0; row < metres.size(); ++row) {
    for (int axis = 0; axis < 3; ++axis) values.push_back(static_cast<float>(metres[row][axis]));
    values.push_back(static_cast<float>(degrees[row]));
  }
  return blobs.add(std::span<const float>(values));
}

void add_truth(const ScanTable& table, Blobs& blobs, Json& json) {
  const auto known = [](const std::optional<Pose>& pose) { return pose.has_value(); };
  if (std::none_of(table.truth.begin(), table.truth.end(), known)) return;
  std::vector<float> truth;
  for (const std::optional<Pose>& pose : table.truth) {
    for (int axis = 0; axis < 3; ++axis)
      truth.push_back(pose ? static_cast<float>(pose->translation[axis]) : kNan);
  }
  json["truth"] = blobs.add(std::span<const float>(truth));
  json["odometry_error"] = error_blob(table.odometry_error, table.odometry_error_deg, blobs);
  json["optimised_error"] = error_blob(table.optimised_error, table.optimised_error_deg, blobs);
}

std::uint8_t state_number(std::string_view state) {
  constexpr std::array<std::string_view, 4> kStates{"good", "weak", "lost", "predicted"};
  const auto* found = std::find(kStates.begin(), kStates.end(), state);
  return static_cast<std::uint8_t>(found - kStates.begin());
}

// Row by row through the strands: f(strand, row, scan among all of the session).
template <typename F>
void for_each_row(const SessionContents& contents, const ScanTable& table, F&& f) {
  for (std::size_t s = 0; s < table.spans.size(); ++s) {
    const RowSpan& span = table.spans[s];
    const std::size_t first =
        contents.first_scan_of(contents.strands[s].part) + contents.strands[s].first_scan;
    for (std::size_t i = 0; i < span.rows; ++i) f(s, span.first_row + i, first + i * span.stride);
  }
}

void add_quality(const SessionContents& contents, const ScanTable& table, Blobs& blobs,
                 Json& json) {
  if (contents.quality.empty()) return;
  std::map<std::size_t, const ScanQuality*> by_scan;
  for (const ScanQuality& q : contents.quality) by_scan[q.scan] = &q;
  constexpr std::uint8_t kUnknown = 4;
  std::vector<std::uint8_t> state(table.rows(), kUnknown);
  std::vector<float> figures(5 * table.rows(), kNan);
  for_each_row(contents, table, [&](std::size_t, std::size_t row, std::size_t scan) {
    const auto found = by_scan.find(scan);
    if (found == by_scan.end()) return;
    const ScanQuality& q = *found->second;
    state[row] = state_number(q.state);
    const auto norm = [&](std::size_t first) {
      return std::sqrt(q.sigma[first] * q.sigma[first] + q.sigma[first + 1] * q.sigma[first + 1] +
                       q.sigma[first + 2] * q.sigma[first + 2]);
    };
    const std::array<double, 5> values{q.correspondences, q.inlier_share, q.residual_m, norm(0),
                                       norm(3) * 180.0 / M_PI};
    for (std::size_t k = 0; k < values.size(); ++k)
      figures[5 * row + k] = static_cast<float>(values[k]);
  });
  json["state"] = blobs.add(std::span<const std::uint8_t>(state));
  json["quality"] = blobs.add(std::span<const float>(figures));
}

// Of the local map that a scan is in: standard deviations of its position and rotation.
void add_uncertainty(const SessionContents& contents, const ScanTable& table, Blobs& blobs,
                     Json& json) {
  if (contents.uncertainty.empty()) return;
  std::map<int, const MapUncertainty*> by_map;
  for (const MapUncertainty& u : contents.uncertainty) by_map[u.map] = &u;
  std::vector<float> sigma(2 * table.rows(), kNan);
  for (std::size_t s = 0; s < table.spans.size(); ++s) {
    const Strand& strand = contents.strands[s];
    const SessionPart& part = contents.session.parts[strand.part];
    const RowSpan& span = table.spans[s];
    std::size_t m = 0;
    for (std::size_t i = 0; i < span.rows; ++i) {
      const std::size_t scan = strand.first_scan + i * span.stride;
      while (m + 1 < part.maps.size() && part.maps[m].last_scan < scan) ++m;
      const auto found = by_map.find(part.first_map + static_cast<int>(m));
      if (found == by_map.end()) continue;
      const auto diagonal = found->second->covariance.diagonal();
      sigma[2 * (span.first_row + i)] = static_cast<float>(std::sqrt(diagonal.head<3>().sum()));
      sigma[2 * (span.first_row + i) + 1] =
          static_cast<float>(std::sqrt(diagonal.tail<3>().sum()) * 180.0 / M_PI);
    }
  }
  json["sigma"] = blobs.add(std::span<const float>(sigma));
}

}  // namespace

Json scan_blobs(const SessionContents& contents, const ScanTable& table, Blobs& blobs) {
  Json json{{"rows", table.rows()}};
  const Nanoseconds first = table.stamps.empty() ? 0 : table.stamps.front();
  json["stamp0"] = std::to_string(first);  // ns; a number of a page would round it
  std::vector<double> stamps;
  for (const Nanoseconds stamp : table.stamps)
    stamps.push_back(static_cast<double>(stamp - first) * 1e-9);
  json["stamp"] = blobs.add(std::span<const double>(stamps));
  json["optimised"] = pose_blob(table.optimised, blobs);
  json["odometry"] = pose_blob(table.odometry, blobs);
  add_truth(table, blobs, json);
  add_quality(contents, table, blobs, json);
  add_uncertainty(contents, table, blobs, json);
  return json;
}

}  // namespace groundloop::apps
