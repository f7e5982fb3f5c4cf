#include "apps/report/report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "apps/report/svg_plot.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

constexpr const char* kStyle = R"(<style>
:root{color-scheme:light dark;--ink:#1c2024;--soft:#60646c;--rule:#d9dce1;--page:#fff;--truth:#7a7f87;
--before:#e07b00;--after:#0068b5;--good:#1a8f5a;--bad:#cc3a2b}
@media(prefers-color-scheme:dark){:root{--ink:#e8eaed;--soft:#a2a7af;--rule:#363a40;--page:#16181b;
--truth:#8d939c;--before:#f2a23c;--after:#58aef0;--good:#45c98a;--bad:#f0705f}}
body{margin:0 auto;padding:24px;max-width:1000px;background:var(--page);color:var(--ink);
font:15px/1.5 system-ui,sans-serif}
h1{font-size:26px;margin:0 0 4px}h2{font-size:19px;margin:36px 0 8px}
p,.note{color:var(--soft);margin:4px 0 10px}figure{margin:12px 0 20px}
figcaption{font-weight:600;margin-bottom:4px}.key{font-weight:400;margin-left:14px;white-space:nowrap}
.key svg{margin-right:5px;vertical-align:middle}
svg.plot{width:100%;height:auto}svg text{fill:var(--soft);font-size:12px}
.grid{stroke:var(--rule);stroke-width:1}polyline{fill:none;stroke-width:1.8;stroke-linejoin:round}
polyline.truth{stroke:var(--truth);stroke-dasharray:6 4}polyline.before{stroke:var(--before)}
polyline.after{stroke:var(--after)}circle.after{fill:var(--after)}
polyline.good,g.good line{stroke:var(--good);stroke-width:2.2}g.good circle{fill:var(--good)}
polyline.bad,g.bad line{stroke:var(--bad);stroke-width:1;stroke-dasharray:3 3}g.bad circle{fill:var(--bad)}
polyline.session0{stroke:#0068b5}polyline.session1{stroke:#e07b00}polyline.session2{stroke:#1a8f5a}
polyline.session3{stroke:#b5429a}polyline.session4{stroke:#8a6d1d}polyline.session5{stroke:#0f9aa8}
.wide{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:3px 12px 3px 0;text-align:right;border-bottom:1px solid var(--rule);white-space:nowrap}
th{font-weight:600}th:first-child,td:first-child{text-align:left}.facts td{text-align:left}td.wrap{white-space:normal;text-align:left}
td.accepted{color:var(--good)}td.rejected{color:var(--bad)}
pre{overflow:auto;border:1px solid var(--rule);padding:12px;font-size:13px}
img{max-width:31%;margin-right:2%;image-rendering:pixelated}
</style>)";

std::string fixed(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string optional_text(const std::optional<double>& value, int decimals) {
  return value ? fixed(*value, decimals) : std::string("–");
}

std::string heading(const std::string& text) { return "<h2>" + escape_html(text) + "</h2>\n"; }
std::string note(const std::string& text) { return "<p>" + escape_html(text) + "</p>\n"; }

std::string table(const std::vector<std::string>& columns,
                  const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<div class=\"wide\"><table>";
  if (!columns.empty()) {
    html += "<tr>";
    for (const std::string& column : columns) html += "<th>" + escape_html(column) + "</th>";
    html += "</tr>";
  }
  for (const auto& row : rows) {
    html += "<tr>";
    for (const std::string& cell : row) {
      const char* kind = cell == "accepted" ? " class=\"accepted\""
                         : cell == "few_inliers" || cell == "icp_diverged" ||
                                 cell == "low_overlap" || cell == "inconsistent" ||
                                 cell == "outlier"
                             ? " class=\"rejected\""
                         : cell.size() > 60 ? " class=\"wrap\""
                                            : "";
      html += std::string("<td") + kind + ">" + escape_html(cell) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

// The three trajectories in the optimised one's world, all aligned to the ground truth where there
// is one.
struct Drawn {
  std::vector<Eigen::Vector3d> odometry, optimised, truth;
};

std::vector<Eigen::Vector3d> positions(const Trajectory& trajectory, const Pose& T, double scale) {
  std::vector<Eigen::Vector3d> result;
  for (const StampedPose& s : trajectory)
    result.push_back(T * Eigen::Vector3d(scale * s.pose.translation));
  return result;
}

Drawn draw(const ReportInput& input) {
  Drawn drawn;
  Pose T_world_truth;
  Pose T_world_odometry;
  double odometry_scale = 1.0;
  if (input.optimised_evaluation) {
    T_world_truth = input.optimised_evaluation->alignment.pose.inverse();
    if (input.odometry_evaluation) {
      T_world_odometry = T_world_truth * input.odometry_evaluation->alignment.pose;
      odometry_scale = input.odometry_evaluation->alignment.scale;
    }
    drawn.truth = positions(input.ground_truth, T_world_truth, 1.0);
  }
  drawn.odometry = positions(input.odometry, T_world_odometry, odometry_scale);
  drawn.optimised = positions(input.optimised, Pose(), 1.0);
  return drawn;
}

PlotSeries series(const char* label, const char* style, const std::vector<Eigen::Vector3d>& points,
                  bool height) {
  PlotSeries result{label, style, {}, false};
  double way = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) way += (points[i] - points[i - 1]).norm();
    if (height) {
      result.points.emplace_back(way, points[i].z());
    } else {
      result.points.emplace_back(points[i].x(), points[i].y());
    }
  }
  return result;
}

std::string closure_text(const ReportClosure& c) {
  return c.query + " to " + c.reference + ", " + c.source + ": " + c.status + ", " +
         std::to_string(c.inliers) + " inliers, overlap " + optional_text(c.overlap, 2);
}

// Accepted ones last, on top.
void add_links(const ReportInput& input, Plot& top) {
  for (const bool accepted : {false, true}) {
    bool any = false;
    for (const ReportClosure& c : input.closures) {
      if ((c.status == "accepted") != accepted) continue;
      any = true;
      top.links.push_back({accepted ? "good" : "bad",
                           {c.reference_position.x(), c.reference_position.y()},
                           {c.query_position.x(), c.query_position.y()},
                           closure_text(c)});
    }
    if (any) {
      top.series.push_back(
          {accepted ? "closure accepted" : "rejected", accepted ? "good" : "bad", {}, false});
    }
  }
}

std::string sessions(const ReportInput& input) {
  constexpr std::size_t kColours = 6;
  Plot top{"From above", "x [m]", "y [m]", true, false, {}, {}};
  Plot height{"Height along the way", "way [m]", "z [m]", false, false, {}, {}};
  for (std::size_t i = 0; i < input.sessions.size(); ++i) {
    const std::string style = "session" + std::to_string(i % kColours);
    const auto points = positions(input.sessions[i].trajectory, Pose(), 1.0);
    const char* name = input.sessions[i].name.c_str();
    top.series.push_back(series(name, style.c_str(), points, false));
    height.series.push_back(series(name, style.c_str(), points, true));
  }
  add_links(input, top);
  return heading("Sessions in one frame") + to_svg(top) + to_svg(height);
}

std::string trajectories(const ReportInput& input) {
  if (!input.sessions.empty()) return sessions(input);
  const Drawn drawn = draw(input);
  std::string html = heading("Trajectory");
  html += note(input.optimised_evaluation
                   ? "In the frame of the first scan. Odometry and ground truth are each brought "
                     "there by their alignment (" +
                         input.evaluation_options.alignment + ")."
                   : "In the frame of the first scan; there is no ground truth.");
  Plot top{"From above", "x [m]", "y [m]", true, false, {}, {}};
  Plot height{"Height along the way", "way [m]", "z [m]", false, false, {}, {}};
  for (const bool is_height : {false, true}) {
    Plot& plot = is_height ? height : top;
    if (!drawn.truth.empty()) {
      plot.series.push_back(series("ground truth", "truth", drawn.truth, is_height));
    }
    plot.series.push_back(series("odometry", "before", drawn.odometry, is_height));
    plot.series.push_back(series("optimised", "after", drawn.optimised, is_height));
  }
  add_links(input, top);
  return html + to_svg(top) + to_svg(height);
}

PlotSeries error_series(const char* label, const char* style,
                        const TrajectoryEvaluation& evaluation, const Trajectory& truth, int axis) {
  PlotSeries result{label, style, {}, false};
  double way = 0.0;
  for (std::size_t i = 0; i < evaluation.pairs.size(); ++i) {
    const Eigen::Vector3d p = truth[evaluation.pairs[i].second].pose.translation;
    if (i > 0) way += (p - truth[evaluation.pairs[i - 1].second].pose.translation).norm();
    const Eigen::Vector3d& e = evaluation.translation_errors[i];
    result.points.emplace_back(way, axis < 0 ? e.norm() : evaluation.rotation_errors_deg[i]);
  }
  return result;
}

std::vector<std::string> statistics_row(const std::string& name, const Statistics& s) {
  std::vector<std::string> row{name};
  for (const double v : {s.rmse, s.mean, s.median, s.std, s.min, s.max}) row.push_back(fixed(v, 3));
  return row;
}

std::string errors(const ReportInput& input) {
  if (!input.optimised_evaluation) return {};
  std::string html = heading("Error against ground truth");
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const TrajectoryEvaluation& e) {
    rows.push_back(statistics_row(name + ": APE [m]", e.ape.translation_m));
    rows.push_back(statistics_row(name + ": along x [m]", e.ape_x_m));
    rows.push_back(statistics_row(name + ": along y [m]", e.ape_y_m));
    rows.push_back(statistics_row(name + ": along z [m]", e.ape_z_m));
    rows.push_back(statistics_row(name + ": APE [deg]", e.ape.rotation_deg));
    rows.push_back(statistics_row(name + ": RPE, 1 pose [m]", e.rpe_frame.translation_m));
    rows.push_back(statistics_row(name + ": RPE, 1 pose [deg]", e.rpe_frame.rotation_deg));
  };
  if (input.odometry_evaluation) add("odometry", *input.odometry_evaluation);
  add("optimised", *input.optimised_evaluation);
  html += table({"", "rmse", "mean", "median", "std", "min", "max"}, rows);
  const TrajectoryEvaluation& e = *input.optimised_evaluation;
  const auto kitti = [](const std::string& name, const TrajectoryEvaluation& t) {
    return t.kitti_segments == 0 ? std::string()
                                 : name + " " + fixed(t.kitti_translation_percent, 3) + " % and " +
                                       fixed(t.kitti_rotation_deg_per_m, 5) + " deg/m. ";
  };
  std::string text =
      std::to_string(e.pairs.size()) + " pairs over " + fixed(e.path_length_m, 0) + " m. ";
  if (input.odometry_evaluation)
    text += kitti("KITTI metric, odometry:", *input.odometry_evaluation);
  text += kitti("KITTI metric, optimised:", e);
  html += note(text);
  for (const int axis : {-1, 3}) {
    Plot plot{axis < 0 ? "Position error along the way" : "Rotation error along the way",
              "way [m]",
              axis < 0 ? "error [m]" : "error [deg]",
              false,
              true,
              {},
              {}};
    if (input.odometry_evaluation) {
      plot.series.push_back(
          error_series("odometry", "before", *input.odometry_evaluation, input.ground_truth, axis));
    }
    plot.series.push_back(
        error_series("optimised", "after", *input.optimised_evaluation, input.ground_truth, axis));
    html += to_svg(plot);
  }
  const std::string association = input.evaluation_options.by_row
                                      ? "Poses are paired by row. "
                                      : "Poses are paired by nearest stamp, at most " +
                                            to_text(input.evaluation_options.tolerance) +
                                            " s apart, each used once. ";
  return html +
         note(
             association + "Alignment: " + input.evaluation_options.alignment +
             " (origin: first poses coincide; se3: least squares over positions without scale, "
             "Umeyama 1991; sim3: with scale). APE: distance of paired positions after alignment, "
             "and angle of R_truth^T R_aligned. Along x, y, z: absolute differences on the axes of "
             "the ground truth. RPE: the pose (truth_i^-1 truth_j)^-1 (estimate_i^-1 estimate_j) "
             "with j the next pair. KITTI metric: end errors of segments of 100 to 800 m from "
             "every "
             "tenth pose over their length, averaged. std is that of the population.");
}

std::string closures(const ReportInput& input) {
  std::string html = heading("Loop closures");
  std::map<std::string, int> count;
  for (const ReportClosure& c : input.closures) ++count[c.status];
  std::string text = std::to_string(input.closures.size()) + " candidates";
  for (const auto& [status, n] : count) text += ", " + std::to_string(n) + " " + status;
  html += note(text +
               ". few_inliers: at most 5 after the final fit; icp_diverged: registration did "
               "not settle or ran far off; low_overlap: too few shared 0.5 m voxels, or tall "
               "structure that disagrees; inconsistent: contradicts other closures; outlier: "
               "given up by the robust solver.");
  bool judged = false;
  for (const ReportClosure& c : input.closures) judged = judged || c.error_m.has_value();
  std::vector<std::string> columns{"reference", "query",   "source", "matches",
                                   "inliers",   "overlap", "rmse m", "status"};
  if (judged) columns.insert(columns.end(), {"error m", "error deg"});
  std::vector<std::vector<std::string>> rows;
  for (const ReportClosure& c : input.closures) {
    rows.push_back({c.reference, c.query, c.source, std::to_string(c.matches),
                    std::to_string(c.inliers), optional_text(c.overlap, 2),
                    optional_text(c.rmse_m, 3), c.status});
    if (judged) {
      rows.back().push_back(optional_text(c.error_m, 2));
      rows.back().push_back(optional_text(c.error_deg, 2));
    }
  }
  if (!rows.empty()) html += table(columns, rows);
  if (judged) {
    html += note(
        "Errors are those of the row's pose against the ground truth's, where the two maps meet; "
        "the latter is itself no better than its source.");
  }
  if (!input.precision_recall.empty()) {
    Plot plot{"Precision and recall of the detector", "recall", "precision", false, true, {}, {}};
    PlotSeries line{"by least inliers", "after", {}, false};
    for (const PrecisionRecallPoint& p : input.precision_recall) {
      line.points.emplace_back(p.recall, p.precision);
    }
    PlotSeries dots{"", "after", line.points, true};
    plot.series = {line, dots};
    html += to_svg(plot);
  }
  return html;
}

std::string base64(const std::vector<std::byte>& bytes) {
  constexpr const char* kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8) | (k < n ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= n ? kAlphabet[(group >> (18 - 6 * k)) & 63U] : '=';
    }
  }
  return text;
}

std::string rest(const ReportInput& input) {
  std::string html;
  for (const ReportTable& t : input.tables) {
    html += heading(t.title);
    if (!t.note.empty()) html += note(t.note);
    html += table(t.columns, t.rows);
  }
  if (!input.timing_s.empty()) {
    html += heading("Time");
    html += note(
        "Busy seconds of each stage; stages overlap, so that total, the clock, is less than "
        "their sum.");
    std::vector<std::vector<std::string>> rows;
    for (const auto& [stage, seconds] : input.timing_s) rows.push_back({stage, fixed(seconds, 2)});
    html += table({"stage", "seconds"}, rows);
  }
  if (!input.images.empty()) {
    html += heading("Density images of closures") +
            note(
                "Seen from above in the ground frame of the reference map: the reference, the "
                "query brought there by the closure's pose, and both. Dark is much structure; in "
                "the third, orange is the reference alone, blue the query alone, dark where they "
                "agree.");
    for (const ReportImage& image : input.images) {
      html += "<figure><figcaption>" + escape_html(image.caption) + "</figcaption>";
      for (const std::vector<std::byte>& png : image.pngs) {
        html += "<img alt=\"" + escape_html(image.caption) + "\" src=\"data:image/png;base64," +
                base64(png) + "\">";
      }
      html += "</figure>\n";
    }
  }
  if (!input.configuration.empty()) {
    html += heading("Configuration") +
            "<details><summary>the whole effective configuration</summary><pre>" +
            escape_html(input.configuration) + "</pre></details>\n";
  }
  return html;
}

}  // namespace

std::string make_report(const ReportInput& input) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>" +
      escape_html(input.title) + "</title>" + kStyle + "</head><body>\n<h1>" +
      escape_html(input.title) + "</h1>\n";
  std::vector<std::vector<std::string>> facts;
  for (const auto& [name, value] : input.facts) facts.push_back({name, value});
  if (!facts.empty()) html += "<div class=\"facts\">" + table({}, facts) + "</div>\n";
  html += trajectories(input) + errors(input) + closures(input) + rest(input);
  return html + "</body></html>\n";
}

}  // namespace groundloop::apps
