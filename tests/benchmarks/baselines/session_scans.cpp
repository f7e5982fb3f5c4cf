#include "tests/benchmarks/baselines/session_scans.hpp"

#include <algorithm>

#include "backend/session/manifest.hpp"
#include "backend/session/table_row.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::baselines {
namespace {

constexpr double kMaxRange = 100.0;  // m, as odometry crops scans
constexpr int kSkippedMaps = 3;

}  // namespace

SessionScans::SessionScans(const std::filesystem::path& session) {
  const SessionFolder folder(session);
  const Manifest manifest = read_complete_manifest(folder);
  if (manifest.merged()) throw InputError(session.string() + ": is merged; give one recording's");
  recording_ = open_any_recording(manifest.recording.at("path").get<std::string>());
  odometry_ = read_tum(folder.file("odometry.tum"));
  std::map<Nanoseconds, std::size_t> by_stamp;
  for (std::size_t i = 0; i < recording_->size(); ++i) by_stamp.emplace(recording_->stamp(i), i);
  for (const StampedPose& pose : odometry_) {
    const auto found = by_stamp.find(pose.stamp);
    if (found == by_stamp.end()) {
      throw InputError(session.string() + ": no scan of " + recording_->info().path +
                       " has stamp " + seconds_text(pose.stamp));
    }
    numbers_.push_back(found->second);
  }
  map_of_.resize(odometry_.size(), 0);
  for (const LocalMapRecord& map : read_local_maps(folder.file("local_maps.csv"))) {
    for (std::size_t i = map.first_scan; i <= map.last_scan; ++i) map_of_[i] = map.map;
  }
}

Points SessionScans::points(std::size_t scan) const {
  // The motion to the next scan, or from the one before.
  const std::size_t a = scan + 1 < odometry_.size() ? scan : scan - 1;
  SensorMotion motion;
  if (odometry_.size() > 1) {
    const double seconds = 1e-9 * static_cast<double>(odometry_[a + 1].stamp - odometry_[a].stamp);
    if (seconds > 0 && seconds < 1) {
      motion.velocity = log_se3(odometry_[a].pose.inverse() * odometry_[a + 1].pose) / seconds;
    }
  }
  const Scan raw = [&] {
    const std::scoped_lock lock(reading_);
    return recording_->read(numbers_[scan]);
  }();
  return deskew_and_crop(raw, motion, 0.0, 0.0, kMaxRange);
}

bool may_report(const SessionScans& references, std::size_t reference, const SessionScans& queries,
                std::size_t query) {
  return &references != &queries ||
         references.map_of(reference) < queries.map_of(query) - kSkippedMaps;
}

void MapPairs::add(const SessionScans& references, std::size_t reference,
                   const SessionScans& queries, std::size_t query, double score,
                   const std::optional<Pose>& T_query_reference) {
  const Best pair{reference, query, score, T_query_reference};
  const auto [it, is_new] =
      best_.try_emplace({queries.map_of(query), references.map_of(reference)}, pair);
  if (!is_new && score > it->second.score) it->second = pair;
}

void MapPairs::write(const std::filesystem::path& file) const {
  std::string text = "reference_scan,query_scan,score,tx,ty,tz,qx,qy,qz,qw\n";
  for (const auto& [maps, best] : best_) {
    text += std::to_string(best.reference) + "," + std::to_string(best.query) + "," +
            to_text(best.score);
    if (best.T_query_reference) {
      append_pose(text, *best.T_query_reference);
    } else {
      text += ",,,,,,,";
    }
    text += "\n";
  }
  write_text_atomically(file, text);
}

}  // namespace groundloop::baselines
