#include "apps/commands/evaluated_sessions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>

#include "apps/commands/ground_truth.hpp"
#include "backend/session/manifest.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/pcd.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxRange = 100.0;  // m, as odometry crops scans
// A pose is taken for a scan's if it lies at most this far from the scan's stamp, or between two
// poses at most twice this apart.
constexpr double kNearStamp = 0.5;  // s

// Ground truth of the sensor at any stamp that it covers, between its poses, at the instant of a
// scan that odometry says its stamps name.
class TruePoses {
 public:
  explicit TruePoses(JudgedTruth truth)
      : trajectory_(std::move(truth.poses)),
        shift_(static_cast<Nanoseconds>(std::llround(truth.instant_s * 1e9))) {}
  [[nodiscard]] bool covers(Nanoseconds stamp) const {
    const auto after =
        std::lower_bound(trajectory_.begin(), trajectory_.end(), stamp + shift_,
                         [](const StampedPose& p, Nanoseconds s) { return p.stamp < s; });
    const auto near = [&](Nanoseconds other) {
      return std::abs(static_cast<double>(other - stamp - shift_)) * 1e-9 <= kNearStamp;
    };
    return (after != trajectory_.end() && near(after->stamp)) ||
           (after != trajectory_.begin() && near((after - 1)->stamp));
  }
  [[nodiscard]] Pose at(Nanoseconds stamp) const { return pose_at(trajectory_, stamp + shift_); }

 private:
  Trajectory trajectory_;
  Nanoseconds shift_;
};

// Frame and instant are what the session's odometry says; `say` puts them into the log.
TruePoses true_poses(const EvaluatedPart& part, const Recording& recording, bool say) {
  const GroundTruth truth = part.ground_truth.empty()
                                ? own_ground_truth(recording)
                                : read_ground_truth(part.ground_truth, part.truth_frame, recording);
  if (truth.poses.empty()) {
    throw InputError(part.recording + ": no ground truth comes with it; give it by --ground-truth");
  }
  JudgedTruth judged = judge_ground_truth(truth, part.odometry);
  if (say) log_ground_truth(truth, judged);
  if (!judged.trusted) {
    throw InputError(truth.source + ": does not fit the odometry of " + part.session.string() +
                     " in any frame; give the ground truth of this recording");
  }
  return TruePoses(std::move(judged));
}

// Points of a scan at the instant of its stamp, deskewed with the true motion.
Points true_points(const Scan& scan, const TruePoses& truth) {
  Vector6d twist = Vector6d::Zero();
  if (!scan.times.empty()) {
    const double last =
        static_cast<double>(*std::max_element(scan.times.begin(), scan.times.end()));
    if (last > 0) {
      const auto end = scan.stamp + static_cast<Nanoseconds>(last * 1e9);
      twist = log_se3(truth.at(scan.stamp).inverse() * truth.at(end)) / last;
    }
  }
  return deskew_and_crop(scan, {twist}, 0.0, 0.0, kMaxRange);
}

// Numbers in `recording` of the scans with these stamps: of all, or of a run of them.
std::vector<std::size_t> find_scans(const Recording& recording, const Trajectory& odometry,
                                    const fs::path& file) {
  std::map<Nanoseconds, std::size_t> by_stamp;
  for (std::size_t i = 0; i < recording.size(); ++i) by_stamp.emplace(recording.stamp(i), i);
  std::vector<std::size_t> numbers;
  for (const StampedPose& pose : odometry) {
    const auto found = by_stamp.find(pose.stamp);
    if (found == by_stamp.end()) {
      throw InputError(file.string() + ": no scan of " + recording.info().path + " has stamp " +
                       seconds_text(pose.stamp) + "; give the recording it was made from");
    }
    numbers.push_back(found->second);
  }
  return numbers;
}

// Scans of a part of a merged session may be counted through all parts; maps partition them.
void count_scans_from_zero(std::vector<LocalMapRecord>& maps) {
  const std::size_t first = maps.empty() ? 0 : maps.front().first_scan;
  for (LocalMapRecord& map : maps) map.first_scan -= first, map.last_scan -= first;
}

void read_tables(EvaluatedPart& part) {
  const fs::path odometry = part.tables / "odometry.tum", table = part.tables / "local_maps.csv";
  part.odometry = read_tum(odometry);
  part.maps = read_local_maps(table);
  count_scans_from_zero(part.maps);
  if (!part.maps.empty() && part.maps.back().last_scan >= part.odometry.size()) {
    throw InputError(table.string() + ": more scans than " + odometry.string());
  }
}

void add_parts(const SessionFolder& session, std::vector<EvaluatedPart>& parts) {
  const Manifest manifest = read_complete_manifest(session);
  const auto add = [&](const std::string& name, const std::string& recording,
                       const fs::path& tables, std::size_t first_map) {
    EvaluatedPart part;
    part.name = name;
    part.recording = recording;
    part.session = session.path();
    part.tables = tables;
    part.first_map = static_cast<int>(first_map);
    parts.push_back(std::move(part));
  };
  for (const ManifestPart& p : manifest.parts) {
    add(p.name, p.recording, session.path() / "sessions" / p.name, p.first_map);
  }
  if (!manifest.merged()) {
    add(session.name(), manifest.recording.at("path").get<std::string>(), session.path(), 0);
  }
}

void expect_one_each(const std::string& option, std::size_t given, std::size_t parts) {
  if (given == 0 || given == parts) return;
  throw InputError(option + ": " + std::to_string(given) + " given, the sessions were made of " +
                   std::to_string(parts) + " recordings");
}

}  // namespace

std::vector<EvaluatedPart> read_parts(const std::vector<fs::path>& sessions,
                                      const std::vector<std::string>& recordings,
                                      const std::vector<std::string>& ground_truths,
                                      const std::string& truth_frame) {
  std::vector<EvaluatedPart> parts;
  for (const fs::path& session : sessions) add_parts(SessionFolder(session), parts);
  expect_one_each("--recording", recordings.size(), parts.size());
  expect_one_each("--ground-truth", ground_truths.size(), parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!recordings.empty()) parts[i].recording = recordings[i];
    if (!ground_truths.empty()) parts[i].ground_truth = ground_truths[i];
    parts[i].truth_frame = truth_frame;
    read_tables(parts[i]);
  }
  return parts;
}

EvaluatedSessions evaluated_sessions(const std::vector<EvaluatedPart>& parts) {
  EvaluatedSessions result;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const EvaluatedPart& part = parts[p];
    const std::unique_ptr<Recording> recording = open_any_recording(part.recording);
    const TruePoses truth = true_poses(part, *recording, true);
    std::size_t uncovered = 0, left_out = 0;
    for (std::size_t m = 0; m < part.maps.size(); ++m) {
      EvaluatedMap map;
      map.key = {static_cast<int>(p), static_cast<int>(m)};
      const LocalMapRecord& record = part.maps[m];
      const Pose T_map_world = part.odometry[record.first_scan].pose.inverse();
      bool covered = true;
      for (std::size_t i = record.first_scan; i <= record.last_scan; ++i) {
        const StampedPose& scan = part.odometry[i];
        const bool known = truth.covers(scan.stamp);
        uncovered += known ? 0 : 1;
        covered = covered && known;
        map.T_world_scan.push_back(truth.at(scan.stamp));
        map.T_map_scan.push_back(T_map_world * scan.pose);
      }
      if (!covered) {
        ++left_out;
        map.T_world_scan.clear();
      }
      result.maps.push_back(std::move(map));
    }
    if (left_out == part.maps.size()) {
      throw InputError(part.recording + ": ground truth covers " +
                       std::to_string(part.odometry.size() - uncovered) + " of " +
                       std::to_string(part.odometry.size()) +
                       " scans and no local map whole; give the ground truth of this recording, "
                       "stamped by the same clock");
    }
    if (left_out > 0) {
      result.notes.push_back(part.recording + ": ground truth does not cover " +
                             std::to_string(uncovered) + " scans; " + std::to_string(left_out) +
                             " local maps are left out");
    }
  }
  return result;
}

void rebuild_points(const std::vector<EvaluatedPart>& parts, std::vector<EvaluatedMap>& maps,
                    const Progress& progress) {
  auto map = maps.begin();
  for (const EvaluatedPart& part : parts) {
    const std::unique_ptr<Recording> recording = open_any_recording(part.recording);
    const TruePoses truth = true_poses(part, *recording, false);
    const std::vector<std::size_t> numbers =
        find_scans(*recording, part.odometry, part.tables / "odometry.tum");
    for (const LocalMapRecord& record : part.maps) {
      LocalMapOptions all;
      all.length = 1e4;
      all.max_path = 1e5;
      all.max_scans = 1000000;
      LocalMapBuilder builder(all);
      for (std::size_t i = record.first_scan; i <= record.last_scan && map->known(); ++i) {
        if (progress) progress("reference maps", i, numbers.size());
        const Pose& T_world_scan = map->T_world_scan[i - record.first_scan];
        (void)builder.add(true_points(recording->read(numbers[i]), truth), T_world_scan);
      }
      if (auto built = builder.finish()) map->points = std::move(built->points);
      ++map;
    }
  }
}

Points own_points(const std::vector<EvaluatedPart>& parts, const MapKey& key) {
  const EvaluatedPart& part = parts[static_cast<std::size_t>(key.session)];
  return read_pcd(SessionFolder(part.session).local_map(part.first_map + key.map));
}

}  // namespace groundloop::apps
