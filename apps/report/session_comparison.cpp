#include "apps/report/session_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

#include "apps/report/closure_table.hpp"
#include "apps/report/scan_table.hpp"
#include "apps/report/session_verdict.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

std::string fixed(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string text(const std::optional<double>& value, int decimals) {
  return value ? fixed(*value, decimals) : std::string("–");
}

std::string change(const std::optional<double>& a, const std::optional<double>& b, int decimals) {
  if (!a || !b) return "";
  const std::string difference = fixed(*b - *a, decimals);
  return *b > *a ? "+" + difference : difference;
}

std::optional<double> number_at(const Json& document, const char* pointer) {
  const Json::json_pointer place(pointer);
  if (!document.contains(place) || !document.at(place).is_number()) return std::nullopt;
  return document.at(place).get<double>();
}

// A session with what is derived from it.
struct Side {
  const SessionContents& contents;
  ScanTable table;
  std::vector<ClosureRow> closures;

  Side(const SessionContents& c, const std::vector<Trajectory>& truths)
      : contents(c), table(make_scan_table(c, truths)), closures(make_closure_rows(c, table)) {}

  [[nodiscard]] std::string name() const { return contents.session.folder.name(); }
  [[nodiscard]] std::optional<double> accepted() const {
    return static_cast<double>(
        std::count_if(contents.session.closures.begin(), contents.session.closures.end(),
                      [](const ClosureRecord& c) { return c.status == ClosureStatus::accepted; }));
  }
  [[nodiscard]] std::optional<double> path() const {
    double way = 0.0;
    for (const SessionPart& part : contents.session.parts) way += path_length(part.trajectory);
    return way;
  }
  // rmse of the first recording.
  [[nodiscard]] std::optional<double> error(bool optimised) const {
    const StrandEvaluation& e = table.evaluations.front();
    const auto& of = optimised ? e.optimised : e.odometry;
    return of ? std::optional(of->ape.translation_m.rmse) : std::nullopt;
  }
};

PageTable figure_table(const Side& a, const Side& b) {
  PageTable table{"Figures",
                  "The error is that of the position, rmse after SE(3) alignment, of the first "
                  "recording.",
                  {"", a.name(), b.name(), "change"},
                  {}};
  const auto add = [&](const char* name, const std::optional<double>& of_a,
                       const std::optional<double>& of_b, int decimals) {
    if (of_a || of_b)
      table.rows.push_back(
          {name, text(of_a, decimals), text(of_b, decimals), change(of_a, of_b, decimals)});
  };
  table.rows.push_back({"verdict", to_string(judge_session(a.contents, a.table, a.closures).trust),
                        to_string(judge_session(b.contents, b.table, b.closures).trust), ""});
  add("scans", static_cast<double>(a.contents.manifest.scans),
      static_cast<double>(b.contents.manifest.scans), 0);
  add("local maps", static_cast<double>(a.contents.manifest.local_maps),
      static_cast<double>(b.contents.manifest.local_maps), 0);
  add("path [m]", a.path(), b.path(), 1);
  add("closures: candidates", static_cast<double>(a.closures.size()),
      static_cast<double>(b.closures.size()), 0);
  add("closures: accepted", a.accepted(), b.accepted(), 0);
  add("error of odometry [m]", a.error(false), b.error(false), 3);
  add("error, optimised [m]", a.error(true), b.error(true), 3);
  const auto metric = [&](const char* name, const char* pointer, int decimals) {
    add(name, number_at(a.contents.metrics, pointer), number_at(b.contents.metrics, pointer),
        decimals);
  };
  metric("surfaces at revisits apart [m]", "/map_quality/after/plane_thickness_m", 3);
  metric("the same by odometry [m]", "/map_quality/before/plane_thickness_m", 3);
  metric("odometry's errors over the stated", "/pose_graph/odometry_scale", 2);
  metric("time [s]", "/timing_s/total", 1);
  metric("peak memory [MB]", "/peak_memory_mb", 0);
  return table;
}

// The first recording of `a` that `b` holds, too, by the stamps of its scans.
struct Shared {
  std::size_t part_a = 0, part_b = 0;
};
std::optional<Shared> shared_recording(const SessionContents& a, const SessionContents& b) {
  constexpr double kTolerance = 1e-6;  // s; the same scans have the same stamps
  for (std::size_t i = 0; i < a.session.parts.size(); ++i) {
    for (std::size_t j = 0; j < b.session.parts.size(); ++j) {
      const Trajectory& ta = a.session.parts[i].trajectory;
      const Trajectory& tb = b.session.parts[j].trajectory;
      const std::size_t common = associate(tb, ta, kTolerance).size();
      if (2 * common > std::min(ta.size(), tb.size()) && common > 1) return Shared{i, j};
    }
  }
  return std::nullopt;
}

std::vector<double> along(const Trajectory& trajectory,
                          const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
  std::vector<double> way;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double step = k == 0 ? 0.0
                               : (trajectory[pairs[k].second].pose.translation -
                                  trajectory[pairs[k - 1].second].pose.translation)
                                     .norm();
    way.push_back((way.empty() ? 0.0 : way.back()) + step);
  }
  return way;
}

PagePlot::Series from_above(const std::string& name, const char* style,
                            const Trajectory& trajectory, const Pose& T) {
  PagePlot::Series series{name, style, {}, {}};
  for (const StampedPose& s : trajectory) {
    const Eigen::Vector3d p = T * s.pose.translation;
    series.x.push_back(p.x());
    series.y.push_back(p.y());
  }
  return series;
}

void add_trajectories(const Side& a, const Side& b, const Shared& shared, Page& page) {
  const Trajectory& ta = a.contents.session.parts[shared.part_a].trajectory;
  const Trajectory& tb = b.contents.session.parts[shared.part_b].trajectory;
  const TrajectoryEvaluation e = evaluate_trajectory(tb, ta);
  const auto row = [](const char* name, const Statistics& s, int decimals) {
    std::vector<std::string> cells{name};
    for (const double v : {s.rmse, s.mean, s.median, s.max}) cells.push_back(fixed(v, decimals));
    return cells;
  };
  page.tables.push_back(
      {"Trajectory",
       "What lies between the two, after SE(3) alignment of " + b.name() + " to " + a.name() +
           ", at " + std::to_string(e.pairs.size()) + " common scans.",
       {"", "rmse", "mean", "median", "max"},
       {row("position [m]", e.ape.translation_m, 3), row("along z [m]", e.ape_z_m, 3),
        row("rotation [deg]", e.ape.rotation_deg, 3)}});
  PagePlot plan{"From above", "", "x [m]", "y [m]", false, {}};
  plan.plan = true;
  plan.series = {from_above(a.name(), "before", ta, Pose()),
                 from_above(b.name(), "after", tb, e.alignment.pose)};
  const std::vector<double> way = along(ta, e.pairs);
  std::vector<double> level;
  std::vector<double> upright;
  for (const Eigen::Vector3d& d : e.translation_errors) {
    level.push_back(d.head<2>().norm());
    upright.push_back(-d.z());
  }
  PagePlot apart{"How far apart, over the way", "", "way [m]", "[m]", false, {}};
  apart.series = {{"horizontal", "after", way, level}, {"vertical", "before", way, upright}};
  page.json["plots"] = {to_json(plan), to_json(apart)};
}

// Query and reference map.
using ClosureKey = std::pair<int, int>;

// Within one recording.
std::map<ClosureKey, const ClosureRecord*> closures_of(const SessionContents& contents,
                                                       std::size_t part) {
  const std::string& name = contents.session.parts[part].name;
  std::map<ClosureKey, const ClosureRecord*> closures;
  for (const ClosureRecord& c : contents.session.closures) {
    if (c.reference_session == name && c.query_session == name)
      closures[{c.query_map, c.reference_map}] = &c;
  }
  return closures;
}

PageTable closure_changes(const Side& a, const Side& b, const Shared& shared) {
  PageTable table{"Closures that changed",
                  "Of the recording that both hold: pairs of local maps that were accepted in one "
                  "of the two.",
                  {"query to reference", a.name(), b.name(), "inliers"},
                  {}};
  std::map<ClosureKey, std::pair<const ClosureRecord*, const ClosureRecord*>> pairs;
  for (const auto& [key, c] : closures_of(a.contents, shared.part_a)) pairs[key].first = c;
  for (const auto& [key, c] : closures_of(b.contents, shared.part_b)) pairs[key].second = c;
  const auto status = [](const ClosureRecord* c) {
    return c == nullptr ? std::string("no candidate") : std::string(to_string(c->status));
  };
  const auto inliers = [](const ClosureRecord* c) {
    return c == nullptr ? std::string("–") : std::to_string(c->inliers);
  };
  const auto accepted = [](const ClosureRecord* c) {
    return c != nullptr && c->status == ClosureStatus::accepted;
  };
  for (const auto& [key, pair] : pairs) {
    if (accepted(pair.first) == accepted(pair.second)) continue;
    table.rows.push_back({std::to_string(key.first) + " to " + std::to_string(key.second),
                          status(pair.first), status(pair.second),
                          inliers(pair.first) + ", " + inliers(pair.second)});
  }
  if (table.rows.empty()) table.note = "The same closures are accepted in both.";
  return table;
}

PageTable option_changes(const Side& a, const Side& b) {
  PageTable table{"Options that differ", "", {"option", a.name(), b.name()}, {}};
  const std::vector<ConfigEntry> of_a = list_config(a.contents.config);
  const std::vector<ConfigEntry> of_b = list_config(b.contents.config);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    if (of_a[i].value != of_b[i].value)
      table.rows.push_back({of_a[i].section + "." + of_a[i].key, of_a[i].value, of_b[i].value});
  }
  if (a.contents.manifest.identity.version != b.contents.manifest.identity.version)
    table.rows.push_back({"version of groundloop", a.contents.manifest.identity.version,
                          b.contents.manifest.identity.version});
  if (table.rows.empty()) table.note = "None.";
  return table;
}

}  // namespace

Page compare_sessions(const SessionContents& a, const std::vector<Trajectory>& truths_a,
                      const SessionContents& b, const std::vector<Trajectory>& truths_b) {
  const Side side_a(a, truths_a);
  const Side side_b(b, truths_b);
  Page page;
  page.title = side_a.name() + " and " + side_b.name();
  page.tables.push_back(figure_table(side_a, side_b));
  if (const std::optional<Shared> shared = shared_recording(a, b)) {
    add_trajectories(side_a, side_b, *shared, page);
    page.tables.push_back(closure_changes(side_a, side_b, *shared));
  } else {
    page.tables.push_back({"Trajectory",
                           "The sessions hold no recording in common, by the stamps of their "
                           "scans: trajectories and closures are not compared.",
                           {},
                           {}});
  }
  page.tables.push_back(option_changes(side_a, side_b));
  return page;
}

}  // namespace groundloop::apps
