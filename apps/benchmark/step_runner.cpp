#include "apps/benchmark/step_runner.hpp"

#include <chrono>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "apps/benchmark/child_process.hpp"
#include "apps/benchmark/suite.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using State = StepOutcome::State;

std::map<std::string, const Step*> by_name(const std::vector<Step>& steps) {
  std::map<std::string, const Step*> found;
  for (const Step& step : steps) found[step.name] = &step;
  return found;
}

// Of a step's command and of what it needs; the same wherever the results lie.
std::string fingerprint(const std::map<std::string, const Step*>& steps, const Step& step,
                        const fs::path& out) {
  std::string text;
  for (std::string word : step.command) {
    for (std::size_t at = word.find(out.string()); at != std::string::npos;
         at = word.find(out.string(), at)) {
      word.replace(at, out.string().size(), "OUT");
    }
    text += word + "\n";
  }
  for (const std::string& need : step.needs) {
    text += fingerprint(steps, *steps.at(need), out) + "\n";
  }
  return hex(checksum(std::string_view(text)));
}

// Of the last attempt at a step; empty where there was none.
std::string stamped_fingerprint(const fs::path& out, const Step& step) {
  const fs::path file = step_stamp(out, step.name);
  std::error_code error;
  if (!fs::exists(file, error)) return {};
  const Json stamp = Json::parse(read_text(file), nullptr, false);
  return stamp.is_object() ? stamp.value("fingerprint", "") : std::string();
}

std::string last_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line, last;
  while (std::getline(in, line)) {
    if (!line.empty()) last = line;
  }
  return last;
}

int free_memory_mb() {
  const long pages = sysconf(_SC_AVPHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  return static_cast<int>(static_cast<double>(pages) * static_cast<double>(size) / (1 << 20));
}

// The steps that fit the patterns, and all they need.
std::set<std::string> wanted(const std::vector<Step>& steps,
                             const std::vector<std::string>& patterns) {
  std::set<std::string> names;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    if (!names.contains(step->name) && !fits_any(step->name, patterns)) continue;
    names.insert(step->name);
    names.insert(step->needs.begin(), step->needs.end());
  }
  return names;
}

struct Running {
  const Step* step;
  std::unique_ptr<ChildProcess> process;
};

class Runner {
 public:
  Runner(const std::vector<Step>& steps, const StepRunnerOptions& options)
      : steps_(steps),
        options_(options),
        names_(by_name(steps)),
        memory_mb_(options.memory_mb > 0 ? options.memory_mb : free_memory_mb()) {
    fs::create_directories(options.out / "steps");
    fs::create_directories(options.out / "logs");
  }

  std::vector<StepOutcome> run(const Progress& progress) {
    const std::set<std::string> names = options_.step.empty()
                                            ? wanted(steps_, options_.only)
                                            : std::set<std::string>{options_.step};
    if (!options_.step.empty()) look_at_needs(*names_.at(options_.step));
    std::vector<const Step*> open;
    for (const Step& step : steps_) {
      if (!names.contains(step.name)) continue;
      if (is_done(steps_, step, options_.out)) {
        outcomes_[step.name] = {step.name, State::done, ""};
      } else {
        open.push_back(&step);
      }
    }
    const std::size_t total = open.size();
    std::vector<Running> running;
    while (!open.empty() || !running.empty()) {
      if (progress) progress("steps", total - open.size() - running.size(), total);
      start_what_can(open, running);
      const std::size_t before = running.size();
      collect(running);
      if (running.size() == before) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    std::vector<StepOutcome> outcomes;
    for (const Step& step : steps_) {
      if (names.contains(step.name)) outcomes.push_back(outcomes_.at(step.name));
    }
    return outcomes;
  }

 private:
  void look_at_needs(const Step& step) {
    for (const std::string& need : step.needs) {
      const bool done = is_done(steps_, *names_.at(need), options_.out);
      outcomes_[need] = {need, done ? State::done : State::blocked, ""};
    }
  }

  void start_what_can(std::vector<const Step*>& open, std::vector<Running>& running) {
    for (auto it = open.begin(); it != open.end();) {
      const Step& step = **it;
      bool ready = true;
      const std::string* broken = nullptr;
      for (const std::string& need : step.needs) {
        const auto outcome = outcomes_.find(need);
        ready = ready && outcome != outcomes_.end();
        if (outcome != outcomes_.end() && outcome->second.state != State::done) broken = &need;
      }
      if (broken != nullptr) {
        outcomes_[step.name] = {step.name, State::blocked, *broken};
        it = open.erase(it);
      } else if (ready && there_is_room(step, running)) {
        start(step, running);
        it = open.erase(it);
      } else {
        ++it;
      }
    }
  }

  [[nodiscard]] bool there_is_room(const Step& step, const std::vector<Running>& running) const {
    if (running.empty()) return true;
    int memory = step.memory_mb;
    for (const Running& r : running) memory += r.step->memory_mb;
    return static_cast<int>(running.size()) < options_.jobs && memory <= memory_mb_;
  }

  void start(const Step& step, std::vector<Running>& running) {
    std::vector<std::string> command;
    if (step.groundloop) {
      command = {options_.groundloop.string(), "--quiet"};
      if (options_.threads > 0) {
        command.insert(command.end(), {"--threads", std::to_string(options_.threads)});
      }
    }
    command.insert(command.end(), step.command.begin(), step.command.end());
    std::error_code error;
    fs::create_directories(step.result.parent_path());
    // What an earlier attempt at this step left: a run goes on from there, unless it was another.
    const bool same =
        stamped_fingerprint(options_.out, step) == fingerprint(names_, step, options_.out);
    if (same && fs::is_directory(step.result, error) && step.command.front() == "run") {
      command.emplace_back("--resume");
    } else {
      fs::remove_all(step.result, error);
    }
    write_stamp(step, command, {-1, 0.0, 0.0, 0.0}, true);
    const fs::path log = log_of(step);
    const fs::path output = step.standard_output.empty() ? log : partial(step);
    try {
      running.push_back({&step, std::make_unique<ChildProcess>(command, output, log)});
    } catch (const InputError& e) {
      finish(step, command, {127, 0.0, 0.0, 0.0}, e.what());
    }
  }

  void collect(std::vector<Running>& running) {
    for (auto it = running.begin(); it != running.end();) {
      const std::optional<ProcessEnd> end = it->process->ended();
      if (!end) {
        ++it;
        continue;
      }
      const Step& step = *it->step;
      if (end->exit_code == 0 && !step.standard_output.empty()) {
        fs::rename(partial(step), step.standard_output);
      }
      finish(step, step.command, *end, end->exit_code == 0 ? "" : last_line(log_of(step)));
      it = running.erase(it);
    }
  }

  void finish(const Step& step, const std::vector<std::string>& command, const ProcessEnd& end,
              std::string why) {
    std::error_code error;
    if (end.exit_code == 0 && !fs::exists(step.result, error)) {
      why = "it left no " + step.result.string();
    }
    const bool failed = end.exit_code != 0 || !why.empty();
    if (failed && why.empty()) why = "exit code " + std::to_string(end.exit_code);
    write_stamp(step, command, end, failed);
    outcomes_[step.name] = {step.name, failed ? State::failed : State::done, why};
    if (failed) {
      spdlog::warn("{} failed: {}", step.name, why);
    } else {
      spdlog::info("{}: {:.1f} s, {:.1f} processor seconds, {:.0f} MB", step.name, end.seconds,
                   end.processor_seconds, end.peak_memory_mb);
    }
  }

  void write_stamp(const Step& step, const std::vector<std::string>& command, const ProcessEnd& end,
                   bool failed) const {
    const Json stamp{{"step", step.name},
                     {"command", command},
                     {"fingerprint", fingerprint(names_, step, options_.out)},
                     {"exit_code", end.exit_code},
                     {"failed", failed},
                     {"seconds", end.seconds},
                     {"processor_seconds", end.processor_seconds},
                     {"peak_memory_mb", end.peak_memory_mb}};
    write_text_atomically(step_stamp(options_.out, step.name), stamp.dump(1) + "\n");
  }

  [[nodiscard]] fs::path log_of(const Step& step) const {
    return options_.out / "logs" / (step.name + ".log");
  }
  [[nodiscard]] static fs::path partial(const Step& step) {
    return step.standard_output.string() + ".part";
  }

  const std::vector<Step>& steps_;
  const StepRunnerOptions& options_;
  std::map<std::string, const Step*> names_;
  int memory_mb_;
  std::map<std::string, StepOutcome> outcomes_;
};

}  // namespace

std::filesystem::path step_stamp(const std::filesystem::path& out, const std::string& step) {
  return out / "steps" / (step + ".json");
}

bool is_done(const std::vector<Step>& steps, const Step& step, const std::filesystem::path& out) {
  const fs::path file = step_stamp(out, step.name);
  std::error_code error;
  if (!fs::exists(file, error) || !fs::exists(step.result, error)) return false;
  const Json stamp = Json::parse(read_text(file), nullptr, false);
  return stamp.is_object() && !stamp.value("failed", true) &&
         stamp.value("fingerprint", "") == fingerprint(by_name(steps), step, out);
}

std::vector<StepOutcome> run_steps(const std::vector<Step>& steps, const StepRunnerOptions& options,
                                   const Progress& progress) {
  return Runner(steps, options).run(progress);
}

}  // namespace groundloop::apps
