#include "apps/cli/command_guide.hpp"

#include <map>
#include <utility>

namespace groundloop::apps {
namespace {

const std::vector<WrittenFile> kSessionFiles = {
    {"report.html", "one page to look at, offline: verdict, map, closures, errors, times"},
    {"trajectory.tum, trajectory.kitti", "one optimised pose a scan"},
    {"odometry.tum", "the same before closing loops"},
    {"map.pcd", "the optimised map; `groundloop export` makes LAS and PLY of it"},
    {"closures.csv", "every candidate for a closure, and why it was kept or not"},
    {"uncertainty.csv", "covariance of every local map's pose"},
    {"pose_graph.g2o, local_maps.csv, local_maps/", "the graph as solved, and the local maps"},
    {"loop_database.bin", "descriptors, keypoints and ground alignments, for later merging"},
    {"metrics.json, manifest.json, config.yaml, run.log",
     "counts, times and errors; input and checksums; every option; what was said"},
};

CommandGuide top() {
  return {
      "A recording goes in; a globally consistent trajectory, a map and a report come out. "
      "Loops are closed by density images of the ground seen from above. `groundloop COMMAND "
      "--help` says what a command takes, with examples and the files it writes.",
      {{"groundloop demo", "see it work, without any data"},
       {"groundloop inspect drive.mcap", "what a recording is"},
       {"groundloop run drive.mcap --out session", "trajectory, map and report of it"},
       {"groundloop doctor session", "what is wrong, and what to try"}},
      {}};
}

CommandGuide run() {
  return {
      "The format is recognised. A run that was stopped goes on with --resume and ends in the "
      "same bytes; a folder that holds a session is replaced only with --overwrite, and only "
      "once the new one is complete.",
      {{"groundloop run drive.mcap --out session", "a bag with one point cloud topic"},
       {"groundloop run kitti/sequences/00 --out session --count 1000",
        "the first thousand scans of a KITTI sequence"},
       {"groundloop run scans/ --out session --ground-truth truth.tum",
        "a folder of .bin, .pcd or .ply files, with errors against a reference"},
       {"groundloop run walk.bag --out session --config handheld "
        "--set odometry.voxel_size=0.5",
        "a preset, and one option changed; `groundloop config` prints them all"}},
      kSessionFiles};
}

CommandGuide demo() {
  return {"Drives a kilometre through a simulated town, with exact ground truth; needs no data.",
          {{"groundloop demo", "leaves a session in groundloop_demo/"},
           {"groundloop demo --out elsewhere", "or in another folder"}},
          kSessionFiles};
}

CommandGuide merge() {
  std::vector<WrittenFile> files = kSessionFiles;
  files.push_back({"sessions/NAME/", "trajectories and local maps of each, in the common frame"});
  return {
      "The first session's frame is the common one. Sessions that cannot be joined keep their "
      "own frame, and the report says so.",
      {{"groundloop merge monday friday --out both", "two recordings of one place"},
       {"groundloop merge map new --fix map --out extended",
        "an old map held as it is, a new recording brought into it"},
       {"groundloop merge a b --matches ab.bin --out both",
        "closures found elsewhere, by `groundloop match`"}},
      files};
}

CommandGuide match() {
  return {
      "The part of a merge that takes the time, by itself: pairs can be matched on different "
      "machines, and the files given to one merge.",
      {{"groundloop match a b --out ab.bin", "closures between two sessions"}},
      {{"the file named by --out", "candidates with poses and verdicts"}}};
}

CommandGuide export_() {
  return {"The ending of --out chooses the format.",
          {{"groundloop export session --out map.las", "the map, a point a decimetre"},
           {"groundloop export session --out map.ply --voxel 0", "every point of the local maps"},
           {"groundloop export session --out poses.csv --uncertainty",
            "every scan's pose with standard deviations"}},
          {{"the file named by --out", "PCD, PLY or LAS of the map, or CSV of the poses"}}};
}

CommandGuide inspect() {
  return {"Reads no more than it must; says what was recognised, and why.",
          {{"groundloop inspect drive.mcap", "format, sensor, rate, times, gaps"},
           {"groundloop inspect drive.mcap --json", "the same for programs"}},
          {}};
}

CommandGuide simulate() {
  return {
      "Worlds are town, bridge and park; keys are sensor, carrier, length, seed, route, change "
      "and noise.",
      {{"groundloop simulate \"sim:town?sensor=spin64&length=600&seed=3\" --layout kitti --out "
        "written",
        "a simulated drive as a KITTI sequence"},
       {"groundloop simulate drive.bag --layout mcap --out converted",
        "any recording in another layout"}},
      {{"the folder named by --out", "a recording of the chosen layout, with ground truth"}}};
}

CommandGuide optimize() {
  return {"",
          {{"groundloop optimize graph.g2o --out solved.g2o", "least squares"},
           {"groundloop optimize graph.g2o --out solved.g2o --robust --report page.html",
            "closures are judged, false ones left out; a page shows which"}},
          {{"the file named by --out", "the solved graph"}}};
}

CommandGuide report() {
  return {
      "",
      {{"groundloop report session", "report.html of the session, made anew"},
       {"groundloop report session --out page.html --points 300000", "a smaller page, elsewhere"}},
      {{"report.html, or the file named by --out", "one page that needs nothing beside it"}}};
}

CommandGuide compare() {
  return {"",
          {{"groundloop compare before after", "figures, trajectory, closures, options"},
           {"groundloop compare before after --out difference.html", "the same with pictures"}},
          {{"the file named by --out, if any", "a page"}}};
}

CommandGuide doctor() {
  return {"Says what was found; the exit code is 0 whatever it is, so long as it can be read.",
          {{"groundloop doctor session", "what a run left behind"},
           {"groundloop doctor drive.mcap", "a recording, before it is run"}},
          {}};
}

CommandGuide benchmark() {
  return {"A suite is a YAML file, or one of those built in (--list).",
          {{"groundloop benchmark suite.yaml --out results", "runs all, and makes the tables"}},
          {{"the folder named by --out", "sessions, measures and tables of the suite"}}};
}

CommandGuide config() {
  return {"",
          {{"groundloop config", "every option with its unit and reason"},
           {"groundloop config handheld > mine.yaml", "a file to change, for --config"}},
          {}};
}

CommandGuide completion() {
  return {
      "",
      {{"groundloop completion bash > ~/.local/share/bash-completion/completions/groundloop",
        "for bash; the Debian package brings it along"},
       {"groundloop completion zsh > ~/.zfunc/_groundloop", "for zsh, where ~/.zfunc is in fpath"},
       {"groundloop completion fish > ~/.config/fish/completions/groundloop.fish", "for fish"}},
      {}};
}

CommandGuide evaluate_trajectory() {
  return {
      "Trajectories of 8 columns are TUM, of 12 KITTI. The alignment is SE(3) unless --align "
      "says otherwise; stamps are matched to the nearest.",
      {{"groundloop evaluate trajectory --estimate session/trajectory.tum --ground-truth "
        "truth.tum",
        "absolute, relative and KITTI errors"}},
      {{"the file named by --report, if any", "a page with the errors along the way"}}};
}

CommandGuide evaluate_closures() {
  return {"",
          {{"groundloop evaluate closures session --ground-truth truth.tum",
            "precision, recall and alignment of what was found"}},
          {}};
}

CommandGuide evaluate_map() {
  return {"", {{"groundloop evaluate map session", "how thin planes are, before and after"}}, {}};
}

const std::map<std::string, CommandGuide, std::less<>>& guides() {
  static const std::map<std::string, CommandGuide, std::less<>> all = {
      {"groundloop", top()},
      {"groundloop run", run()},
      {"groundloop demo", demo()},
      {"groundloop merge", merge()},
      {"groundloop match", match()},
      {"groundloop export", export_()},
      {"groundloop inspect", inspect()},
      {"groundloop simulate", simulate()},
      {"groundloop optimize", optimize()},
      {"groundloop report", report()},
      {"groundloop compare", compare()},
      {"groundloop doctor", doctor()},
      {"groundloop benchmark", benchmark()},
      {"groundloop config", config()},
      {"groundloop completion", completion()},
      {"groundloop evaluate trajectory", evaluate_trajectory()},
      {"groundloop evaluate closures", evaluate_closures()},
      {"groundloop evaluate map", evaluate_map()},
  };
  return all;
}

// By option, or by "command option" where a command means something else by it.
const std::map<std::string, ValueGuide, std::less<>>& values() {
  static const std::map<std::string, ValueGuide, std::less<>> all = {
      {"--out", {"FILE", Completes::file}},
      {"run --out", {"FOLDER", Completes::folder}},
      {"demo --out", {"FOLDER", Completes::folder}},
      {"merge --out", {"FOLDER", Completes::folder}},
      {"simulate --out", {"FOLDER", Completes::folder}},
      {"benchmark --out", {"FOLDER", Completes::folder}},
      {"--config", {"FILE|PRESET", Completes::file}},
      {"--set", {"KEY=VALUE"}},
      {"--ground-truth", {"FILE", Completes::file}},
      {"merge --ground-truth", {"NAME=FILE", Completes::file}},
      {"--truth-frame", {"sensor|camera|FILE", Completes::file}},
      {"--truth", {"FILE", Completes::file}},
      {"--estimate", {"FILE", Completes::file}},
      {"--report", {"FILE.html", Completes::file}},
      {"--closures", {"FILE", Completes::file}},
      {"--pairs", {"WHICH"}},
      {"report --closures", {"N"}},
      {"--only", {"PATTERN"}},
      {"--step", {"STEP"}},
      {"--reference-poses", {"KIND"}},
      {"--overlap", {"SHARE"}},
      {"--overlap-between-sessions", {"SHARE"}},
      {"--memory", {"MB"}},
      {"--limit", {"METRES"}},
      {"--references", {"FILE", Completes::file}},
      {"--matches", {"FILE", Completes::file}},
      {"--calibration", {"FILE", Completes::file}},
      {"--png", {"FILE.png", Completes::file}},
      {"--recording", {"RECORDING", Completes::file}},
      {"--compare", {"FOLDER", Completes::folder}},
      {"--data", {"FOLDER", Completes::folder}},
      {"--fix", {"SESSION", Completes::folder}},
      {"--fields", {"NAMES"}},
      {"--format", {"NAME"}},
      {"--topic", {"NAME"}},
      {"--sensor", {"NAME"}},
      {"--layout", {"LAYOUT"}},
      {"--dataset", {"NAME"}},
      {"--time-unit", {"UNIT"}},
      {"--stamp", {"INSTANT"}},
      {"--align", {"KIND"}},
      {"--initialisation", {"KIND"}},
      {"--tolerance", {"SECONDS"}},
      {"--voxel", {"METRES"}},
      {"--cell", {"METRES"}},
      {"RECORDING", {"RECORDING", Completes::file}},
      {"SESSION", {"SESSION", Completes::folder}},
      {"REFERENCE", {"SESSION", Completes::folder}},
      {"QUERY", {"SESSION", Completes::folder}},
      {"A", {"SESSION", Completes::folder}},
      {"B", {"SESSION", Completes::folder}},
      {"PATH", {"PATH", Completes::file}},
      {"SIM", {"RECORDING", Completes::file}},
      {"GRAPH", {"FILE.g2o", Completes::file}},
      {"SUITE", {"SUITE", Completes::file}},
      {"PRESET", {"PRESET", Completes::file}},
  };
  return all;
}

}  // namespace

CommandGuide command_guide(std::string_view path) {
  const auto found = guides().find(path);
  return found == guides().end() ? CommandGuide{} : found->second;
}

ValueGuide value_guide(std::string_view command, std::string_view option) {
  const std::string own = std::string(command) + " " + std::string(option);
  if (const auto found = values().find(own); found != values().end()) return found->second;
  if (const auto found = values().find(option); found != values().end()) return found->second;
  return {option.substr(0, 2) == "--" ? "N" : std::string(option)};
}

}  // namespace groundloop::apps
