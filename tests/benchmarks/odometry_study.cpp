// Odometry alone over a recording, as often as asked, as a table in Markdown: variants of the
// configuration against each other, and each under perturbations that a sound odometry hardly
// notices (perturbed_recording.hpp).
//
//   groundloop_odometry_study [--truth FILE] [--first N] [--count N] [--perturb NAME,NAME...]
//                             [--variant "NAME: KEY=VALUE KEY=VALUE..."]... [--poses FILE]
//                             [--quality FILE] [--threads N] RECORDING [KEY=VALUE]...
//
// APE: rmse of positions after SE(3) alignment; drift: mean error of segments of 100 to 800 m (the
// KITTI metric); step: rms error of position and angle from scan to scan; thickness: median
// standard deviation across surfaces in 1 m cells of 40 scans (surface_thickness.hpp); ms:
// processor time a scan, of odometry alone. --truth takes a KITTI file with a row a scan, or a TUM
// file; without it the recording's own truth is used. --poses writes the odometry of the last row
// as TUM, --quality how well it went as the session's odometry_quality.csv.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <sstream>
#include <string>
#include <vector>

#include "apps/config/config.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/mapping/odometry_table.hpp"
#include "backend/mapping/odometry_trust.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"
#include "frontend/odometry/odometry.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "tests/benchmarks/perturbed_recording.hpp"
#include "tests/benchmarks/surface_thickness.hpp"

namespace groundloop {
namespace {

struct Variant {
  std::string name = "default";
  std::vector<std::string> settings;
};

struct Arguments {
  std::string recording, truth, poses, quality;
  RecordingOptions options;
  std::vector<std::string> perturbations{"none"}, settings;
  std::vector<Variant> variants;
};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) {
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

Arguments parse(int count, char** words) {
  Arguments result;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = [&]() -> std::string {
      if (i + 1 >= count) throw InputError(word + ": needs a value");
      return words[++i];
    };
    if (word == "--truth") {
      result.truth = value();
    } else if (word == "--poses") {
      result.poses = value();
    } else if (word == "--quality") {
      result.quality = value();
    } else if (word == "--first") {
      result.options.first = std::stoul(value());
    } else if (word == "--count") {
      result.options.count = std::stoul(value());
    } else if (word == "--threads") {
      set_thread_count(std::stoi(value()));
    } else if (word == "--perturb") {
      result.perturbations = split(value(), ',');
    } else if (word == "--variant") {
      const std::string text = value();
      const std::size_t colon = text.find(':');
      result.variants.push_back(
          {text.substr(0, colon),
           split(colon == std::string::npos ? "" : text.substr(colon + 1), ' ')});
    } else if (result.recording.empty()) {
      result.recording = word;
    } else {
      result.settings.push_back(word);
    }
  }
  if (result.recording.empty()) throw InputError("which recording?");
  if (result.variants.empty()) result.variants.emplace_back();
  return result;
}

// A given truth stands in for the recording's own.
class WithTruth final : public Recording {
 public:
  WithTruth(std::unique_ptr<Recording> inner, const std::string& file) : inner_(std::move(inner)) {
    try {
      const std::vector<Pose> poses = read_kitti_poses(file);
      if (poses.size() != inner_->size())
        throw InputError(file + ": not as many poses as the recording has scans");
      for (std::size_t i = 0; i < poses.size(); ++i) truth_.push_back({inner_->stamp(i), poses[i]});
    } catch (const InputError&) {
      truth_ = read_tum(file);
    }
  }
  const RecordingInfo& info() const override { return inner_->info(); }
  std::size_t size() const override { return inner_->size(); }
  Nanoseconds stamp(std::size_t index) const override { return inner_->stamp(index); }
  Scan read(std::size_t index) override { return inner_->read(index); }
  Trajectory ground_truth() const override { return truth_; }

 private:
  std::unique_ptr<Recording> inner_;
  Trajectory truth_;
};

double processor_seconds() {
  std::timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Row {
  Trajectory odometry;
  double thickness = 0.0, seconds = 0.0, iterations = 0.0;
  std::vector<ScanQuality> quality;
};

Row run_odometry(Recording& recording, const OdometryOptions& options) {
  Row row;
  Odometry odometry(options);
  SurfaceThickness thickness;
  if (recording.size() > 1) odometry.start(recording.read(0), recording.read(1));
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const Scan scan = recording.read(i);
    const double start = processor_seconds();
    const RegisteredScan result = odometry.add(scan, "scan " + std::to_string(i));
    row.seconds += processor_seconds() - start;
    row.iterations += result.iterations;
    row.odometry.push_back({scan.stamp, result.T_world_scan});
    row.quality.push_back(result.quality);
    thickness.add(result.points, result.T_world_scan);
  }
  row.thickness = thickness.median();
  return row;
}

void print(const std::string& name, const std::string& perturbation, const Row& row,
           const Trajectory& truth) {
  const auto scans = static_cast<double>(row.odometry.size());
  std::printf("| %s | %s | %zu | %.1f |", name.c_str(), perturbation.c_str(), row.odometry.size(),
              path_length(row.odometry));
  if (truth.empty()) {
    std::printf(" | | |");
  } else {
    TrajectoryEvaluationOptions options;
    options.by_row = truth.size() == row.odometry.size();
    const TrajectoryEvaluation e = evaluate_trajectory(row.odometry, truth, options);
    std::printf(" %.3f |", e.ape.translation_m.rmse);
    if (e.kitti_segments > 0) {
      std::printf(" %.3f |", e.kitti_translation_percent);
    } else {
      std::printf(" |");
    }
    std::printf(" %.1f, %.3f |", 100.0 * e.rpe_frame.translation_m.rmse,
                e.rpe_frame.rotation_deg.rmse);
  }
  const OdometryTrust trust = trust_of(row.quality, row.odometry);
  std::printf(" %.1f | %.1f | %zu, %zu, %zu | %s | %.1f |\n", 1e3 * row.thickness,
              row.iterations / scans, trust.count(OdometryState::weak),
              trust.count(OdometryState::lost), trust.count(OdometryState::predicted),
              trust.lost.empty() ? "" : std::to_string(trust.lost.front().first_scan).c_str(),
              1e3 * row.seconds / scans);
  std::fflush(stdout);
}

void run(const Arguments& arguments) {
  std::printf("%s\n\n", arguments.recording.c_str());
  std::printf(
      "| variant | perturbation | scans | path, m | APE, m | drift, %% | step, cm and deg | "
      "thickness, mm | iterations | weak, lost, predicted | lost from | ms |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  Row last;
  for (const Variant& variant : arguments.variants) {
    std::vector<std::string> settings = arguments.settings;
    settings.insert(settings.end(), variant.settings.begin(), variant.settings.end());
    const apps::Config config = apps::effective_config("", settings);
    for (const std::string& perturbation : arguments.perturbations) {
      RecordingOptions options = arguments.options;
      options.elevation_correction = config.recording.elevation_correction;
      std::unique_ptr<Recording> recording = open_any_recording(arguments.recording, options);
      if (!arguments.truth.empty())
        recording = std::make_unique<WithTruth>(std::move(recording), arguments.truth);
      recording = perturb(std::move(recording), perturbation);
      const Row row = run_odometry(*recording, config.slam.odometry);
      print(variant.name, perturbation, row, recording->ground_truth());
      last = row;
    }
  }
  if (!arguments.poses.empty()) write_tum(arguments.poses, last.odometry);
  if (!arguments.quality.empty()) write_odometry_quality(arguments.quality, last.quality);
}

}  // namespace
}  // namespace groundloop

int main(int count, char** words) {
  try {
    groundloop::run(groundloop::parse(count, words));
    return 0;
  } catch (const groundloop::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
