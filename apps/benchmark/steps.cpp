#include "apps/benchmark/steps.hpp"

#include <algorithm>
#include <set>

#include "apps/benchmark/suite_node.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;

bool is_simulated(const std::string& path) { return path.rfind("sim:", 0) == 0; }

std::string id_of(const std::string& name, const std::string& repetition) {
  return repetition.empty() ? name : name + "~" + repetition;
}

std::vector<std::string> configuration_arguments(const std::string& preset,
                                                 const std::vector<std::string>& settings) {
  std::vector<std::string> arguments;
  if (!preset.empty()) arguments.insert(arguments.end(), {"--config", preset});
  for (const std::string& setting : settings) {
    arguments.insert(arguments.end(), {"--set", setting});
  }
  return arguments;
}

class Planner {
 public:
  Planner(const Suite& suite, const BenchmarkFolders& folders)
      : suite_(suite), data_(folders.data), out_(folders.out), programs_(folders.programs) {}

  SuitePlan plan() {
    for (const SuiteRecording& recording : suite_.recordings) check(recording);
    for (const SuiteConfiguration& configuration : suite_.configurations) {
      for (const SuiteRecording& recording : suite_.recordings) {
        // A pair's recordings are run as well, whatever their own groups.
        if (is_missing(recording.name)) continue;
        const bool reported = fits_any(recording.group, configuration.groups);
        if (reported || in_a_pair(recording.name, configuration)) {
          add_recording(recording, configuration, reported);
        }
      }
      for (const SuitePair& pair : suite_.pairs) {
        if (fits_any(pair.group, configuration.groups)) add_pair(pair, configuration);
      }
    }
    return std::move(plan_);
  }

 private:
  [[nodiscard]] std::string absolute(const std::string& path) const {
    return is_simulated(path) ? path : (data_ / path).lexically_normal().string();
  }
  [[nodiscard]] bool is_missing(const std::string& name) const { return missing_.contains(name); }
  [[nodiscard]] const SuiteRecording& recording(const std::string& name) const {
    return *std::find_if(suite_.recordings.begin(), suite_.recordings.end(),
                         [&](const SuiteRecording& r) { return r.name == name; });
  }
  [[nodiscard]] bool in_a_pair(const std::string& name,
                               const SuiteConfiguration& configuration) const {
    return std::any_of(suite_.pairs.begin(), suite_.pairs.end(), [&](const SuitePair& p) {
      return (p.reference == name || p.query == name) && fits_any(p.group, configuration.groups) &&
             !is_missing(p.reference) && !is_missing(p.query);
    });
  }
  [[nodiscard]] fs::path session(const SuiteConfiguration& c, const std::string& name) const {
    return out_ / "sessions" / id_of(c.name, c.repetition) / name;
  }
  [[nodiscard]] static std::string run_step(const SuiteConfiguration& c, const std::string& name) {
    return "run~" + id_of(c.name, c.repetition) + "~" + name;
  }

  // Names what of a recording is not there.
  void check(const SuiteRecording& r) {
    if (is_simulated(r.path)) return;
    std::vector<std::string> needed{r.path};
    needed.insert(needed.end(), r.needs.begin(), r.needs.end());
    if (!r.ground_truth.empty()) needed.push_back(r.ground_truth);
    const std::string& frame = r.truth_frame;
    if (!frame.empty() && frame != "sensor" && frame != "camera") needed.push_back(frame);
    std::string missing;
    std::vector<std::string> named;
    for (const std::string& path : needed) {
      const std::string file = absolute(path);
      // What lies in a folder that is missing need not be named as well.
      const bool within = std::any_of(named.begin(), named.end(), [&](const std::string& folder) {
        return file == folder || file.rfind(folder + "/", 0) == 0;
      });
      if (within || fs::exists(file)) continue;
      named.push_back(file);
      missing += (missing.empty() ? "" : ", ") + file;
    }
    if (missing.empty()) return;
    missing_.insert(r.name);
    plan_.gaps.push_back({"recording " + r.name, "missing: " + missing});
  }

  void add_recording(const SuiteRecording& r, const SuiteConfiguration& c, bool reported) {
    Step step;
    step.name = run_step(c, r.name);
    step.result = session(c, r.name);
    step.memory_mb = r.memory_mb;
    step.command = {"run", absolute(r.path), "--out", step.result.string()};
    if (!r.format.empty()) step.command.insert(step.command.end(), {"--format", r.format});
    if (!r.topic.empty()) step.command.insert(step.command.end(), {"--topic", r.topic});
    const std::vector<std::string> truth = ground_truth_arguments({&r});
    step.command.insert(step.command.end(), truth.begin(), truth.end());
    step.command.insert(step.command.end(), r.options.begin(), r.options.end());
    // Maps are not what is measured; a configuration may ask for them all the same.
    step.command.insert(step.command.end(), {"--set", "map.write=false"});
    const std::vector<std::string> config = configuration_arguments(c.preset, c.settings);
    step.command.insert(step.command.end(), config.begin(), config.end());
    plan_.steps.push_back(step);
    if (!reported) return;
    for (const std::string& references : r.references) {
      const std::string judge = add_evaluation({&r}, c, "", "", references, {step.name});
      ResultSource source = source_of("recording", r.name, r.group, c, references);
      source.step = judge;
      source.metrics = source.session = step.result / "metrics.json";
      source.closures = document("closures", c, r.name, references);
      source.measured_step = step.name;
      plan_.sources.push_back(source);
      for (const SuiteDetector& d : suite_.detectors) {
        if (!d.own() && d.command.empty()) continue;
        if (fits_any(c.name, d.configurations) && fits_any(r.group, d.groups)) {
          add_detector(d, {&r}, r.name, r.group, c, references, {judge, step.name});
        }
      }
    }
  }

  void add_pair(const SuitePair& p, const SuiteConfiguration& c) {
    for (const std::string& name : {p.reference, p.query}) {
      if (!is_missing(name)) continue;
      if (&c == &suite_.configurations.front()) {
        plan_.gaps.push_back({"pair " + p.name, "recording " + name + " is missing"});
      }
      return;
    }
    const SuiteRecording &reference = recording(p.reference), &query = recording(p.query);
    const std::vector<const SuiteRecording*> both{&reference, &query};
    const std::vector<std::string> runs{run_step(c, p.reference), run_step(c, p.query)};
    const std::vector<std::string> config = configuration_arguments(c.preset, c.settings);
    Step match;
    match.name = "match~" + id_of(c.name, c.repetition) + "~" + p.name;
    match.result = out_ / "matches" / id_of(c.name, c.repetition) / (p.name + ".csv");
    match.command = {"match", session(c, p.reference).string(), session(c, p.query).string(),
                     "--out", match.result.string()};
    match.command.insert(match.command.end(), config.begin(), config.end());
    match.needs = runs;
    match.memory_mb = std::max(reference.memory_mb, query.memory_mb);
    plan_.steps.push_back(match);
    Step merge;
    if (p.merge) {
      merge.name = "merge~" + id_of(c.name, c.repetition) + "~" + p.name;
      merge.result = out_ / "merged" / id_of(c.name, c.repetition) / p.name;
      merge.command = {"merge",
                       session(c, p.reference).string(),
                       session(c, p.query).string(),
                       "--out",
                       merge.result.string(),
                       "--matches",
                       match.result.string(),
                       "--set",
                       "map.write=false"};
      for (const SuiteRecording* r : both) {
        if (r->ground_truth.empty()) continue;
        merge.command.insert(merge.command.end(),
                             {"--ground-truth", r->name + "=" + absolute(r->ground_truth)});
      }
      merge.command.insert(merge.command.end(), config.begin(), config.end());
      merge.needs = {match.name};
      merge.memory_mb = reference.memory_mb + query.memory_mb;
      plan_.steps.push_back(merge);
    }
    for (const std::string& references : reference.references) {
      const std::string judge =
          add_evaluation(both, c, p.name, match.result.string(), references, {match.name});
      ResultSource source = source_of("pair", p.name, p.group, c, references);
      source.step = p.merge ? merge.name : judge;
      source.metrics = p.merge ? merge.result / "metrics.json" : fs::path();
      source.closures = document("closures", c, p.name, references);
      source.measured_step = p.merge ? merge.name : match.name;
      source.expected_to_join = p.overlap;
      plan_.sources.push_back(source);
      for (const SuiteDetector& d : suite_.detectors) {
        if (!d.own() && d.pair_command.empty()) continue;
        if (fits_any(c.name, d.configurations) && fits_any(p.group, d.groups)) {
          add_detector(d, both, p.name, p.group, c, references, {judge, match.name});
        }
      }
    }
  }

  // A detector's list for a recording or a pair, and its evaluation.
  void add_detector(const SuiteDetector& d, const std::vector<const SuiteRecording*>& recordings,
                    const std::string& subject, const std::string& group,
                    const SuiteConfiguration& c, const std::string& references,
                    const std::vector<std::string>& needs) {
    const std::string id = id_of(d.name, d.repetition);
    Step detect;
    detect.name = "detect~" + id + "~" + id_of(c.name, c.repetition) + "~" + subject;
    detect.result = out_ / "lists" / id_of(c.name, c.repetition) / id / (subject + ".csv");
    detect.needs = {needs.back()};
    for (const SuiteRecording* r : recordings) {
      detect.memory_mb = std::max(detect.memory_mb, r->memory_mb);
    }
    std::vector<std::string> sessions;
    for (const SuiteRecording* r : recordings) sessions.push_back(session(c, r->name).string());
    if (d.own()) {
      detect.command = {"match"};
      detect.command.insert(detect.command.end(), sessions.begin(), sessions.end());
      detect.command.insert(detect.command.end(), {"--out", detect.result.string(), "--anew",
                                                   "--set", "closures.verification=false"});
      std::vector<std::string> settings = c.settings;
      // A preset of its own stands in place of the session's configuration.
      if (!d.preset.empty()) settings.clear();
      settings.insert(settings.end(), d.settings.begin(), d.settings.end());
      const std::vector<std::string> config =
          configuration_arguments(d.preset.empty() ? c.preset : d.preset, settings);
      detect.command.insert(detect.command.end(), config.begin(), config.end());
    } else {
      detect.groundloop = false;
      Words words{{"programs", programs_.string()},
                  {"out", detect.result.string()},
                  {"session", sessions.front()},
                  {"reference", sessions.front()},
                  {"query", sessions.back()}};
      for (const std::string& word : recordings.size() == 1 ? d.command : d.pair_command) {
        detect.command.push_back(with_words(word, words));
      }
    }
    const bool known = std::any_of(plan_.steps.begin(), plan_.steps.end(),
                                   [&](const Step& s) { return s.name == detect.name; });
    if (!known) plan_.steps.push_back(detect);
    const std::string key = id + "~" + subject;
    // After the evaluation of the session's own closures, whose references it takes over.
    const std::string judge = add_evaluation(recordings, c, key, detect.result.string(), references,
                                             {needs.front(), detect.name});
    ResultSource source = source_of("", subject, group, c, references);
    source.result.kind = recordings.size() == 1 ? "recording" : "pair";
    if (recordings.size() == 1) source.session = fs::path(sessions.front()) / "metrics.json";
    source.result.detector = d.name;
    if (!d.repetition.empty()) {
      source.result.repetition += (c.repetition.empty() ? "" : " ") + d.repetition;
    }
    source.step = judge;
    source.closures = document("closures", c, key, references);
    source.measured_step = detect.name;
    plan_.sources.push_back(source);
  }

  // `evaluate closures` of a session's own closures, or of a list. Returns the step's name.
  std::string add_evaluation(const std::vector<const SuiteRecording*>& recordings,
                             const SuiteConfiguration& c, const std::string& key,
                             const std::string& list, const std::string& references,
                             const std::vector<std::string>& needs) {
    const std::string subject = key.empty() ? recordings.front()->name : key;
    const std::string of = references == "truth" ? "" : "~" + references;
    Step step;
    step.name = "evaluate~" + id_of(c.name, c.repetition) + "~" + subject + of;
    step.standard_output = document("closures", c, subject, references);
    step.result = step.standard_output;
    step.needs = needs;
    step.command = {"evaluate", "closures"};
    std::string pair;
    for (const SuiteRecording* r : recordings) {
      step.command.push_back(session(c, r->name).string());
      pair += (pair.empty() ? "" : "+") + r->name;
      step.memory_mb = std::max(step.memory_mb, r->memory_mb);
    }
    step.command.insert(step.command.end(), {"--json", "--reference-poses", references});
    step.command.insert(
        step.command.end(),
        {"--references",
         (out_ / "references" / id_of(c.name, c.repetition) / (pair + of + ".csv")).string()});
    const std::vector<std::string> truth = ground_truth_arguments(recordings);
    step.command.insert(step.command.end(), truth.begin(), truth.end());
    if (!list.empty()) step.command.insert(step.command.end(), {"--closures", list});
    plan_.steps.push_back(step);
    return step.name;
  }

  [[nodiscard]] std::vector<std::string> ground_truth_arguments(
      const std::vector<const SuiteRecording*>& recordings) const {
    std::vector<std::string> arguments;
    for (const SuiteRecording* r : recordings) {
      if (r->ground_truth.empty()) continue;
      arguments.insert(arguments.end(), {"--ground-truth", absolute(r->ground_truth)});
    }
    const std::string& frame = recordings.front()->truth_frame;
    if (!frame.empty()) {
      const bool word = frame == "sensor" || frame == "camera";
      arguments.insert(arguments.end(), {"--truth-frame", word ? frame : absolute(frame)});
    }
    return arguments;
  }

  [[nodiscard]] fs::path document(const std::string& kind, const SuiteConfiguration& c,
                                  const std::string& subject, const std::string& references) const {
    const std::string of = references == "truth" ? "" : "~" + references;
    return out_ / kind / id_of(c.name, c.repetition) / (subject + of + ".json");
  }

  static ResultSource source_of(const std::string& kind, const std::string& subject,
                                const std::string& group, const SuiteConfiguration& c,
                                const std::string& references) {
    ResultSource source;
    source.result.kind = kind;
    source.result.subject = subject;
    source.result.group = group;
    source.result.configuration = c.name;
    source.result.repetition = c.repetition;
    source.result.references = references;
    return source;
  }

  const Suite& suite_;
  fs::path data_, out_, programs_;
  std::set<std::string> missing_;
  SuitePlan plan_;
};

}  // namespace

SuitePlan plan_suite(const Suite& suite, const BenchmarkFolders& folders) {
  return Planner(suite, folders).plan();
}

}  // namespace groundloop::apps
