// `groundloop doctor SESSION|RECORDING`: reads what is there and says what is wrong and what to
// try.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/commands/ground_truth.hpp"
#include "apps/report/session_verdict.hpp"
#include "backend/session/manifest.hpp"
#include "frontend/core/error.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

void print(const Verdict& verdict) {
  std::printf("%s\n", verdict.headline.c_str());
  for (const Remark& remark : verdict.remarks) {
    std::printf("  %-9s %s\n", to_string(remark.trust), remark.text.c_str());
    if (!remark.advice.empty()) std::printf("            try: %s\n", remark.advice.c_str());
  }
}

Verdict examine_session(const SessionFolder& folder) {
  const Manifest manifest = read_manifest(folder);
  if (manifest.stage != SessionStage::complete) {
    return make_verdict({{Trust::untrusted,
                          std::string("The session is unfinished: it has come to '") +
                              to_string(manifest.stage) + "'.",
                          "the command that began it, with --resume"}});
  }
  const SessionContents contents = read_session_contents(folder.path());
  const ScanTable table = make_scan_table(contents, true_trajectories(contents.session));
  return judge_session(contents, table, make_closure_rows(contents, table));
}

Verdict examine_recording(const std::string& path) {
  const std::unique_ptr<Recording> recording = open_any_recording(path);
  const RecordingInfo& info = recording->info();
  std::printf("%s: %s, %zu scans, %s\n", info.path.c_str(), info.format.c_str(), recording->size(),
              info.sensor.empty() ? "sensor not stated" : info.sensor.c_str());
  std::vector<Remark> remarks;
  for (const std::string& warning : info.warnings)
    remarks.push_back({Trust::careful, warning, "groundloop inspect, which shows the recording"});
  const auto add = [&](std::size_t n, const char* what, const char* advice) {
    if (n > 0) remarks.push_back({Trust::careful, std::to_string(n) + " " + what + ".", advice});
  };
  add(info.gaps, "gaps in time",
      "look at the time between scans in the report; --first and --count leave out a bad stretch");
  add(info.dropped_scans, "scans cannot be used", "groundloop inspect, which names what is wrong");
  add(info.out_of_order, "scans are out of order", "nothing: they are put in order");
  add(info.duplicates, "scans are there twice", "nothing: one of each is used");
  if (info.point_times == "none") {
    remarks.push_back(
        {Trust::careful,
         "Points have no times of their own: scans are taken as deskewed, and what the "
         "sensor moved within one cannot be put right.",
         "--fields, if they have times under another name"});
  }
  if (recording->size() < 10) {
    remarks.push_back({Trust::untrusted,
                       "Only " + std::to_string(recording->size()) + " scans were found.",
                       "--format or --topic, if another reader or topic is meant"});
  }
  return make_verdict(std::move(remarks));
}

}  // namespace

void add_doctor_command(CLI::App& app, Context&) {
  CLI::App* command =
      app.add_subcommand("doctor", "what is wrong with a session or a recording, and what to try");
  auto path = std::make_shared<std::string>();
  command->add_option("PATH", *path, "session folder, or recording")->required();
  command->callback([path] {
    const SessionFolder folder{fs::path(*path)};
    print(has_manifest(folder) ? examine_session(folder) : examine_recording(*path));
  });
}

}  // namespace groundloop::apps
