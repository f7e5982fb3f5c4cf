#include "apps/report/session_verdict.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

// A registration in a hundred that holds nothing is a stretch to look at; a fifth of them is no
// odometry any more.
constexpr double kCarefulShare = 0.01;
constexpr double kUntrustedShare = 0.2;
// Closures that are farther than this from the ground truth close the wrong loop (the evaluation of
// closures draws the same line).
constexpr double kFalseClosure = 3.0;  // m
// LiDAR odometry without any loop errs by 1 % of the way or less where it works.
constexpr double kErrorOfWay = 0.02;
constexpr double kLeastError = 1.0;  // m; what a short way makes look large
// Odometry that errs by so many times what it states was not what the solution took it for.
constexpr double kOdometryScale = 5.0;
// On a way of this length drift is metres, and only a closure could have told.
constexpr double kLongWay = 500.0;  // m

std::string number(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string counted(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

// Null where the document has no such place.
Json at(const Json& document, const char* pointer) {
  const Json::json_pointer place(pointer);
  return document.contains(place) ? document.at(place) : Json();
}

double number_at(const Json& document, const char* pointer) {
  const Json value = at(document, pointer);
  return value.is_number() ? value.get<double>() : 0.0;
}

bool true_at(const Json& document, const char* pointer) {
  const Json value = at(document, pointer);
  return value.is_boolean() && value.get<bool>();
}

void judge_odometry(const SessionContents& contents, std::vector<Remark>& remarks) {
  std::size_t scans = 0;
  for (const Strand& strand : contents.strands) scans += strand.scans;
  const auto add = [&](const std::string& what, std::size_t n, double careful, double untrusted,
                       const char* advice) {
    const double share =
        static_cast<double>(n) / static_cast<double>(std::max<std::size_t>(1, scans));
    if (n == 0 || share < careful) return;
    remarks.push_back({share >= untrusted ? Trust::untrusted : Trust::careful,
                       what + " at " + std::to_string(n) + " of " + std::to_string(scans) +
                           " scans (" + number(100.0 * share, 1) + " %).",
                       advice});
  };
  const auto count = [&](const char* state) {
    return static_cast<std::size_t>(
        std::count_if(contents.quality.begin(), contents.quality.end(),
                      [&](const ScanQuality& q) { return q.state == state; }));
  };
  constexpr const char* kBlocked =
      "--first and --count, to leave out the stretch where the view is blocked";
  constexpr const char* kPresets =
      "--config handheld for a sensor that is carried, --config narrow_view for one that sees a "
      "part of the round";
  if (contents.quality.empty()) {
    add("Poses are predicted and not measured, the view being blocked,",
        static_cast<std::size_t>(number_at(contents.metrics, "/predicted_scans")), kCarefulShare,
        kUntrustedShare, kBlocked);
  } else {
    const Json first = at(contents.metrics, "/odometry/lost/0");
    const std::string from =
        first.is_object() ? ", first at scan " + number(number_at(first, "/first_scan"), 0) + ", " +
                                number(number_at(first, "/from_s"), 1) + " s after the start,"
                          : std::string();
    add("Odometry lost its way" + from, count("lost"), 0.0, 0.0, kPresets);
    add("Odometry is weak, held by too little of what it saw,", count("weak"), 0.05, 0.5, kPresets);
    add("Poses are predicted and not measured, the view being blocked,", count("predicted"),
        kCarefulShare, kUntrustedShare, kBlocked);
  }
  if (!contents.merged() && contents.frame_names.size() > 1) {
    remarks.push_back({Trust::untrusted,
                       "Odometry broke, and " + std::to_string(contents.frame_names.size()) +
                           " pieces could not be joined: each is in a frame of its own.",
                       kPresets});
  }
}

void judge_solution(const SessionContents& contents, std::vector<Remark>& remarks) {
  const Json& metrics = contents.metrics;
  if (true_at(metrics, "/map_quality/worse")) {
    const bool given_up = true_at(metrics, "/map_quality/given_up");
    remarks.push_back({given_up ? Trust::careful : Trust::untrusted,
                       given_up ? "Closing loops made the surfaces at revisits worse; the closures "
                                  "were given up, and the trajectory is the odometry."
                                : "Closing loops made the surfaces at revisits worse, and the "
                                  "result was kept as the configuration asks."});
  }
  const double scale = number_at(metrics, "/pose_graph/odometry_scale");
  if (scale > kOdometryScale) {
    remarks.push_back({Trust::careful, "As far as the closures tell, odometry errs " +
                                           number(scale, 1) + " times as much as it states."});
  }
  const double way = number_at(metrics, "/path_length_m");
  if (!contents.merged() && way > kLongWay && number_at(metrics, "/closures/accepted") == 0.0) {
    remarks.push_back({Trust::careful,
                       "No loop was closed over " + number(way, 0) +
                           " m: nothing corrects what odometry drifted.",
                       "--config narrow_view where the sensor sees a part of the round; a way that "
                       "never comes back has no loop to close"});
  }
}

void judge_against_truth(const SessionContents& contents, const ScanTable& table,
                         const std::vector<ClosureRow>& closures, std::vector<Remark>& remarks) {
  for (std::size_t s = 0; s < table.evaluations.size(); ++s) {
    const StrandEvaluation& e = table.evaluations[s];
    if (!e.optimised || !e.odometry) continue;
    const std::string& name = contents.strands[s].name;
    const std::string of = contents.strands.size() > 1 ? "'" + name + "': " : std::string();
    const double error = e.optimised->ape.translation_m.rmse;
    const double before = e.odometry->ape.translation_m.rmse;
    const double way = e.optimised->path_length_m;
    if (error > kLeastError && error > kErrorOfWay * way) {
      remarks.push_back(
          {Trust::untrusted,
           of + "It is " + number(error, 2) + " m (rmse) off the ground truth over a way of " +
               number(way, 0) + " m.",
           "--config handheld where the sensor is carried; --truth-frame, if the truth "
           "is of another sensor"});
    }
    if (error > kLeastError && error > 1.1 * before) {
      remarks.push_back({Trust::careful, of + "The solution is farther from the ground truth (" +
                                             number(error, 2) + " m rmse) than odometry alone (" +
                                             number(before, 2) + " m)."});
    }
  }
  std::size_t wrong = 0;
  for (const ClosureRow& row : closures) {
    const bool accepted = contents.session.closures[row.closure].status == ClosureStatus::accepted;
    wrong += accepted && row.error && row.error->m > kFalseClosure ? 1 : 0;
  }
  if (wrong > 0) {
    remarks.push_back({Trust::untrusted,
                       counted(wrong, "accepted closure is", "accepted closures are") +
                           " more than " + number(kFalseClosure, 0) + " m off the ground truth."});
  }
}

void judge_input(const SessionContents& contents, std::vector<Remark>& remarks) {
  const Json& recording = contents.manifest.recording;
  const auto add = [&](const char* key, const char* one, const char* many) {
    const Json value =
        recording.is_object() && recording.contains(key) ? recording.at(key) : Json();
    const auto n = value.is_number() ? value.get<std::size_t>() : 0;
    if (n > 0)
      remarks.push_back({Trust::careful, "The recording has " + counted(n, one, many) + "."});
  };
  const Json warnings = at(recording, "/warnings");
  for (const Json& warning : warnings) {
    if (warning.is_string()) remarks.push_back({Trust::careful, warning.get<std::string>()});
  }
  add("gaps", "gap in time", "gaps in time");
  add("dropped_scans", "scan that could not be used", "scans that could not be used");
  add("out_of_order", "scan out of order", "scans out of order");
  add("duplicates", "scan twice", "scans twice");
}

void judge_merge(const SessionContents& contents, std::vector<Remark>& remarks) {
  for (const ManifestPart& part : contents.manifest.parts) {
    if (part.frame == contents.manifest.parts.front().frame) continue;
    remarks.push_back({Trust::careful, "'" + part.name + "' could not be joined to '" +
                                           contents.manifest.parts.front().name +
                                           "': it is shown apart, in the frame of '" + part.frame +
                                           "', and map.pcd does not hold it."});
  }
  for (const ManifestLeftOut& l : contents.manifest.left_out)
    remarks.push_back({Trust::careful, "Left out: " + l.input + ": " + l.reason});
}

}  // namespace

Verdict judge_session(const SessionContents& contents, const ScanTable& table,
                      const std::vector<ClosureRow>& closures) {
  std::vector<Remark> remarks;
  judge_odometry(contents, remarks);
  judge_solution(contents, remarks);
  judge_against_truth(contents, table, closures, remarks);
  judge_merge(contents, remarks);
  judge_input(contents, remarks);
  for (const std::string& note : table.notes)
    remarks.push_back({Trust::careful, "No errors against ground truth: " + note});
  for (const std::string& fault : contents.unreadable) remarks.push_back({Trust::careful, fault});
  return make_verdict(std::move(remarks));
}

}  // namespace groundloop::apps
