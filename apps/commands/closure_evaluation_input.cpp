#include "apps/commands/closure_evaluation_input.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>

#include "apps/commands/run.hpp"
#include "backend/session/manifest.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/trajectory.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxRange = 100.0;  // m, as odometry crops scans

// Ground truth at any stamp, between its poses.
class TruePoses {
 public:
  TruePoses(Trajectory trajectory, const std::string& recording)
      : trajectory_(std::move(trajectory)) {
    if (trajectory_.empty()) {
      throw InputError(recording + ": no ground truth comes with it; give it by --ground-truth");
    }
  }
  [[nodiscard]] Pose at(Nanoseconds stamp) const {
    const auto after =
        std::lower_bound(trajectory_.begin(), trajectory_.end(), stamp,
                         [](const StampedPose& p, Nanoseconds s) { return p.stamp < s; });
    if (after == trajectory_.end()) return trajectory_.back().pose;
    if (after->stamp == stamp || after == trajectory_.begin()) return after->pose;
    const StampedPose& before = *(after - 1);
    const double s = static_cast<double>(stamp - before.stamp) /
                     static_cast<double>(after->stamp - before.stamp);
    return interpolate(before.pose, after->pose, s);
  }

 private:
  Trajectory trajectory_;
};

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

void add_maps(const EvaluatedPart& part, int session, const std::string& ground_truth,
              const Progress& progress, std::vector<EvaluatedMap>& maps) {
  const std::unique_ptr<Recording> recording = open_any_recording(part.recording);
  const TruePoses truth(ground_truth.empty() ? recording->ground_truth()
                                             : read_ground_truth(ground_truth, *recording),
                        part.recording);
  const fs::path odometry_file = part.tables / "odometry.tum";
  const std::vector<std::size_t> numbers =
      find_scans(*recording, read_tum(odometry_file), odometry_file);
  const fs::path table = part.tables / "local_maps.csv";
  std::size_t first_scan = 0;
  for (const LocalMapRecord& record : read_local_maps(table)) {
    // Scans of a part of a merged session may be counted through all parts; maps partition them.
    const std::size_t scans = record.last_scan - record.first_scan + 1;
    if (first_scan + scans > numbers.size()) {
      throw InputError(table.string() + ": more scans than " + odometry_file.string());
    }
    LocalMapOptions all;
    all.length = 1e4;
    all.max_path = 1e5;
    all.max_scans = 1000000;
    LocalMapBuilder builder(all);
    EvaluatedMap map;
    map.key = {session,
               static_cast<int>(std::count_if(maps.begin(), maps.end(), [&](const EvaluatedMap& m) {
                 return m.key.session == session;
               }))};
    for (std::size_t i = first_scan; i < first_scan + scans; ++i) {
      if (progress) progress("reference maps", i, numbers.size());
      const Scan scan = recording->read(numbers[i]);
      const Pose T_world_scan = truth.at(scan.stamp);
      if (i == first_scan) map.T_world_map = T_world_scan;
      map.positions.push_back(T_world_scan.translation);
      (void)builder.add(true_points(scan, truth), T_world_scan);
    }
    if (auto built = builder.finish()) map.points = std::move(built->points);
    maps.push_back(std::move(map));
    first_scan += scans;
  }
}

}  // namespace

std::vector<EvaluatedPart> read_parts(const SessionFolder& session,
                                      const std::vector<std::string>& recordings) {
  const Manifest manifest = read_complete_manifest(session);
  std::vector<EvaluatedPart> parts;
  for (const ManifestPart& p : manifest.parts) {
    parts.push_back(
        {p.name, p.recording, session.path() / "sessions" / p.name, static_cast<int>(p.first_map)});
  }
  // closures.csv of one recording names no session.
  if (!manifest.merged()) {
    parts.push_back({"", manifest.recording.at("path").get<std::string>(), session.path(), 0});
  }
  if (!recordings.empty()) {
    if (recordings.size() != parts.size()) {
      throw InputError("--recording: " + std::to_string(recordings.size()) + " given, " +
                       session.path().string() + " was made of " + std::to_string(parts.size()));
    }
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i].recording = recordings[i];
  }
  return parts;
}

ClosureEvaluationInput read_evaluation_input(const SessionFolder& session,
                                             const std::vector<std::string>& recordings,
                                             const std::vector<std::string>& ground_truths,
                                             const Progress& progress) {
  ClosureEvaluationInput input;
  input.parts = read_parts(session, recordings);
  if (!ground_truths.empty() && ground_truths.size() != input.parts.size()) {
    throw InputError("--ground-truth: " + std::to_string(ground_truths.size()) + " given, " +
                     session.path().string() + " was made of " +
                     std::to_string(input.parts.size()) + " recordings");
  }
  std::map<std::string, int> session_of;
  for (std::size_t p = 0; p < input.parts.size(); ++p) {
    session_of[input.parts[p].name] = static_cast<int>(p);
    add_maps(input.parts[p], static_cast<int>(p), ground_truths.empty() ? "" : ground_truths[p],
             progress, input.maps);
  }
  const fs::path file = session.file("closures.csv");
  for (const ClosureRecord& record : read_closures(file)) {
    // A session that was moved keeps the name it had in its table.
    const auto number = [&](const std::string& name) {
      if (input.parts.size() == 1) return 0;
      const auto found = session_of.find(name);
      if (found == session_of.end()) {
        throw InputError(file.string() + ": session " + name + " is not in the manifest");
      }
      return found->second;
    };
    ReportedClosure closure;
    closure.reference = {number(record.reference_session), record.reference_map};
    closure.query = {number(record.query_session), record.query_map};
    closure.detector = record.source == ClosureSource::detector;
    closure.accepted = record.status == ClosureStatus::accepted;
    closure.inliers = record.inliers;
    closure.T_query_reference = record.T_query_reference;
    closure.initial_T_query_reference = record.initial_T_query_reference;
    input.closures.push_back(closure);
  }
  return input;
}

}  // namespace groundloop::apps
