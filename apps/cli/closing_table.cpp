#include "apps/cli/closing_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "apps/cli/terminal.hpp"
#include "apps/cli/wrapping.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

double number(const Json& metrics, const char* place) {
  const Pointer pointer(place);
  return metrics.contains(pointer) && metrics.at(pointer).is_number()
             ? metrics.at(pointer).get<double>()
             : 0.0;
}

bool has(const Json& metrics, const char* place) {
  const Pointer pointer(place);
  return metrics.contains(pointer) && metrics.at(pointer).is_number();
}

std::string fixed(double value, int digits) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*f", digits, value);
  return buffer;
}

// With blanks between thousands.
std::string count(double value) {
  std::string digits = fixed(value, 0);
  for (std::size_t place = 3; place < digits.size(); place += 4)
    digits.insert(digits.size() - place, " ");
  return digits;
}

std::string plural(double number_of, const std::string& one) {
  return count(number_of) + " " + one + (number_of == 1.0 ? "" : "s");
}

std::string scans(const Json& metrics) {
  std::string text = plural(number(metrics, "/scans"), "scan");
  if (const double predicted = number(metrics, "/predicted_scans"); predicted > 0.0)
    text += " (" + count(predicted) + " of them only predicted)";
  return text + ", " + count(number(metrics, "/path_length_m")) + " m, " +
         plural(number(metrics, "/local_maps"), "local map");
}

std::string closures(const Json& metrics) {
  return count(number(metrics, "/closures/accepted")) + " accepted of " +
         plural(number(metrics, "/closures/candidates"), "candidate");
}

// Nothing where there is no ground truth.
std::string error(const Json& metrics) {
  if (!has(metrics, "/ape/optimised/translation_m/rmse")) return "";
  std::string text = "APE ";
  if (has(metrics, "/ape/odometry/translation_m/rmse"))
    text += fixed(number(metrics, "/ape/odometry/translation_m/rmse"), 2) + " m by odometry, ";
  return text + fixed(number(metrics, "/ape/optimised/translation_m/rmse"), 2) +
         " m optimised (rmse after SE(3) alignment)";
}

std::string map_quality(const Json& metrics) {
  if (number(metrics, "/map_quality/pairs") == 0.0) return "";
  std::string text =
      "planes at revisits " + fixed(number(metrics, "/map_quality/before/plane_thickness_m"), 3) +
      " m thick by odometry, " + fixed(number(metrics, "/map_quality/after/plane_thickness_m"), 3) +
      " m optimised";
  if (metrics["map_quality"].value("given_up", false)) text += ": worse, and so odometry was kept";
  return text;
}

std::string clock(double seconds) {
  const auto s = static_cast<long>(std::lround(seconds));
  if (s < 60) return fixed(seconds, 1) + " s";
  return std::to_string(s / 60) + " min " + std::to_string(s % 60) + " s";
}

// The clock, then the stages that kept the processor busiest.
std::string time(const Json& metrics) {
  std::string text = clock(number(metrics, "/timing_s/total"));
  if (const double rate = number(metrics, "/scans_per_second"); rate > 0.0)
    text += ", " + fixed(rate, 1) + " scans a second";
  std::vector<std::pair<double, std::string>> stages;
  for (const auto& [name, seconds] : metrics.at("timing_s").items()) {
    if (name != "total" && seconds.is_number()) stages.emplace_back(seconds.get<double>(), name);
  }
  std::stable_sort(stages.begin(), stages.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string busy;
  for (std::size_t i = 0; i < std::min<std::size_t>(4, stages.size()); ++i) {
    if (stages[i].first < 0.05) break;
    std::string name = stages[i].second;
    std::replace(name.begin(), name.end(), '_', ' ');
    busy += (busy.empty() ? "" : ", ") + name + " " + fixed(stages[i].first, 1) + " s";
  }
  return busy.empty() ? text : text + " (busy: " + busy + ")";
}

// What a look at the figures suggests.
std::vector<std::pair<std::string, std::string>> next_steps(const Json& metrics,
                                                            const std::string& folder) {
  std::vector<std::pair<std::string, std::string>> steps;
  const bool doubtful =
      number(metrics, "/closures/accepted") == 0.0 || number(metrics, "/predicted_scans") > 0.0 ||
      (metrics.contains("map_quality") && metrics["map_quality"].value("worse", false));
  if (doubtful)
    steps.emplace_back("groundloop doctor " + folder, "what may be wrong, and what to try");
  steps.emplace_back("groundloop export " + folder + " --out map.las",
                     "the map for other programs");
  if (!doubtful && !metrics.contains("sessions"))
    steps.emplace_back("groundloop merge " + folder + " ANOTHER --out both",
                       "with another recording");
  return steps;
}

}  // namespace

std::string closing_table(const Json& metrics, const std::filesystem::path& folder,
                          std::size_t width, bool coloured) {
  constexpr std::size_t kColumn = 14;
  std::string name = folder.string();
  while (name.size() > 1 && name.back() == '/') name.pop_back();
  std::string text;
  const auto row = [&](const std::string& left, const std::string& right) {
    if (!right.empty()) text += two_columns(left, right, kColumn, width);
  };
  row("scans", scans(metrics));
  row("closures", closures(metrics));
  row("error", error(metrics));
  row("map", map_quality(metrics));
  row("time", time(metrics));
  row("memory", fixed(number(metrics, "/peak_memory_mb"), 0) + " MB at most");
  text += "\n";
  row("look at", bold(name + "/report.html", coloured));
  row("poses", name + "/trajectory.tum");
  bool first = true;
  for (const auto& [command, purpose] : next_steps(metrics, name)) {
    // A command is for copying: never broken; what it is for goes below it where room is short.
    std::string line = first ? "  next" : "";
    line.resize(kColumn, ' ');
    line += command;
    const bool fits = columns_of(line) + 4 + columns_of(purpose) <= width;
    text += line + (fits ? "  # " : "\n" + std::string(kColumn + 2, ' ') + "# ") + purpose + "\n";
    first = false;
  }
  return "\n" + text + "\n";
}

}  // namespace groundloop::apps
