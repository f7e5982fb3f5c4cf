#include "apps/inspection/proposed_run.hpp"

#include <algorithm>
#include <filesystem>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/ground_truth.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

// Text files in the recording's folder and the two above it that hold poses at its scans' stamps,
// or one a scan.
std::vector<fs::path> truth_beside(const std::string& path, const Recording& recording) {
  constexpr std::uintmax_t kLargest = 64U << 20U;
  constexpr std::size_t kMostFiles = 100;
  std::vector<Nanoseconds> stamps;
  for (std::size_t i = 0; i < recording.size(); ++i) stamps.push_back(recording.stamp(i));
  std::vector<fs::path> found;
  std::error_code error;
  fs::path folder = fs::absolute(path, error).lexically_normal();
  if (!folder.has_filename() || !fs::is_directory(folder, error)) folder = folder.parent_path();
  for (int up = 0; up < 3 && folder.has_relative_path(); ++up, folder = folder.parent_path()) {
    std::size_t tried = 0;
    for (const char* extension : {".txt", ".tum", ".csv"}) {
      std::vector<fs::path> files;
      try {
        files = list_files(folder, extension);
      } catch (const InputError&) {
        continue;
      }
      for (const fs::path& file : files) {
        if (fs::file_size(file, error) > kLargest || error || ++tried > kMostFiles) continue;
        try {
          const Trajectory truth = recordings::read_ground_truth(file, stamps);
          const bool meets = std::any_of(truth.begin(), truth.end(), [&](const StampedPose& pose) {
            return pose.stamp >= stamps.front() && pose.stamp <= stamps.back();
          });
          if (meets && truth.size() > 1) found.push_back(file);
        } catch (const InputError&) {
          continue;  // no poses
        }
      }
    }
  }
  return found;
}

// As it would be written from here.
std::string short_path(const fs::path& file) {
  std::error_code error;
  const fs::path relative = fs::relative(file, error);
  const bool below = !error && !relative.empty() && *relative.begin() != "..";
  return below ? relative.string() : file.string();
}

}  // namespace

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("/._-+=:,@%").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

ProposedRun propose_run(const std::vector<std::string>& paths, const RecordingOptions& options,
                        const Recording& recording) {
  const RecordingInfo& info = recording.info();
  ProposedRun proposed;
  proposed.command = "groundloop run";
  for (const std::string& path : paths) proposed.command += " " + shell_word(path);
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) proposed.command += std::string(" ") + option + " " + shell_word(value);
  };
  add("--format", options.format);
  add("--topic", options.topic);
  add("--fields", options.fields);
  add("--dataset", options.dataset);
  add("--calibration", options.calibration);
  add("--time-unit", options.time_unit);
  add("--stamp", options.stamp);
  std::vector<std::string>& to_add = proposed.to_add;
  const bool simulated = info.format == "sim";
  if (!simulated && recording.ground_truth().empty()) {
    const std::vector<fs::path> truths = truth_beside(paths.front(), recording);
    if (!truths.empty()) add("--ground-truth", short_path(truths.front()));
    for (std::size_t i = 1; i < truths.size(); ++i)
      to_add.push_back("--ground-truth " + shell_word(short_path(truths[i])) +
                       " instead, if that is the truth");
  }
  add("--out", "session");
  const auto has = [](const std::vector<std::string>& sentences, const char* text) {
    return std::any_of(sentences.begin(), sentences.end(), [&](const std::string& sentence) {
      return sentence.find(text) != std::string::npos;
    });
  };
  if (info.stamp_source.starts_with("assumed"))
    to_add.emplace_back(
        "times.txt beside the scans, one stamp in seconds a line: the rate is assumed without it");
  if (info.point_times.starts_with("none") && options.fields.empty() && !simulated) {
    to_add.emplace_back(
        "times of the points, if the sensor gave any (--fields names them in headerless files): "
        "without, scans are taken as deskewed");
  }
  if (has(info.notes, "model's manual"))
    to_add.emplace_back("--calibration FILE, the sensor's own: the angles are the model's");
  if (has(info.notes, "add --dataset kitti"))
    to_add.emplace_back(
        "--dataset kitti, if the scans are KITTI's: their elevation is then put right");
  if (recording.size() < 2) to_add.emplace_back("more scans: a single one has no trajectory");
  return proposed;
}

}  // namespace groundloop::apps
