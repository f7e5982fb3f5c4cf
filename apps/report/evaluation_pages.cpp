#include "apps/report/evaluation_pages.hpp"

#include <array>
#include <cstdio>

#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

std::string fixed(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string general(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

std::vector<std::string> statistics_row(const std::string& name, const Statistics& s) {
  std::vector<std::string> row{name};
  for (const double v : {s.rmse, s.mean, s.median, s.std, s.min, s.max}) row.push_back(fixed(v, 4));
  return row;
}

PageTable error_table(const TrajectoryEvaluation& e, const TrajectoryEvaluationOptions& options) {
  const std::string pairing =
      options.by_row ? "by row"
                     : "by the nearest stamp within " + to_text(options.tolerance) + " s";
  return {"Errors",
          std::to_string(e.pairs.size()) + " pairs over " + fixed(e.path_length_m, 1) +
              " m, paired " + pairing + "; alignment " + options.alignment + ", scale " +
              fixed(e.alignment.scale, 6) +
              ". Position: distance after alignment; relative: of the motion to the next pair, or "
              "over a distance.",
          {"", "rmse", "mean", "median", "std", "min", "max"},
          {statistics_row("position [m]", e.ape.translation_m),
           statistics_row("along x [m]", e.ape_x_m), statistics_row("along y [m]", e.ape_y_m),
           statistics_row("along z [m]", e.ape_z_m),
           statistics_row("rotation [deg]", e.ape.rotation_deg),
           statistics_row("relative, 1 pose [m]", e.rpe_frame.translation_m),
           statistics_row("relative, 1 pose [deg]", e.rpe_frame.rotation_deg),
           statistics_row("relative, " + fixed(e.rpe_distance_m, 0) + " m [m]",
                          e.rpe_distance.translation_m)}};
}

// Metres of true way to each pair.
std::vector<double> way_of(const Trajectory& truth, const TrajectoryEvaluation& e) {
  std::vector<double> way;
  for (std::size_t k = 0; k < e.pairs.size(); ++k) {
    const Eigen::Vector3d& p = truth[e.pairs[k].second].pose.translation;
    const double step = k == 0 ? 0.0 : (p - truth[e.pairs[k - 1].second].pose.translation).norm();
    way.push_back((way.empty() ? 0.0 : way.back()) + step);
  }
  return way;
}

}  // namespace

Page trajectory_page(const std::string& title, const Trajectory& estimate, const Trajectory& truth,
                     const TrajectoryEvaluation& e, const TrajectoryEvaluationOptions& options) {
  Page page;
  page.title = title;
  page.figures = {{"position error, rmse", fixed(e.ape.translation_m.rmse, 3) + " m"},
                  {"rotation error, rmse", fixed(e.ape.rotation_deg.rmse, 3) + "°"},
                  {"pairs", std::to_string(e.pairs.size())},
                  {"path", fixed(e.path_length_m, 0) + " m"}};
  if (e.kitti_segments > 0) {
    page.figures.emplace_back("KITTI's segments", fixed(e.kitti_translation_percent, 3) + " %, " +
                                                      fixed(e.kitti_rotation_deg_per_m, 5) +
                                                      " °/m");
  }
  page.tables = {error_table(e, options)};
  PagePlot plan{"From above", "In the frame of the ground truth.", "x [m]", "y [m]", false, {}};
  plan.plan = true;
  PagePlot::Series is{"estimate, aligned", "after", {}, {}};
  PagePlot::Series should{"ground truth", "truth", {}, {}};
  for (const StampedPose& s : estimate) {
    const Eigen::Vector3d p =
        e.alignment.pose * Eigen::Vector3d(e.alignment.scale * s.pose.translation);
    is.x.push_back(p.x());
    is.y.push_back(p.y());
  }
  for (const StampedPose& s : truth) {
    should.x.push_back(s.pose.translation.x());
    should.y.push_back(s.pose.translation.y());
  }
  plan.series = {should, is};
  const std::vector<double> way = way_of(truth, e);
  PagePlot::Series level{"horizontal", "after", way, {}};
  PagePlot::Series upright{"vertical, up is positive", "before", way, {}};
  for (const Eigen::Vector3d& d : e.translation_errors) {
    level.y.push_back(d.head<2>().norm());
    upright.y.push_back(-d.z());
  }
  const PagePlot position{
      "Position error over the way", "", "way [m]", "[m]", false, {level, upright}};
  const PagePlot rotation{"Rotation error over the way",
                          "",
                          "way [m]",
                          "[deg]",
                          true,
                          {{"", "after", way, e.rotation_errors_deg}}};
  page.json["plots"] = {to_json(plan), to_json(position), to_json(rotation)};
  return page;
}

Page graph_page(const std::string& title, const std::vector<Pose>& before, const PoseGraph& graph,
                const OptimizationSummary& summary) {
  Page page;
  page.title = title;
  page.figures = {{"cost", general(summary.cost_before) + " → " + general(summary.cost_after)},
                  {"vertices", std::to_string(graph.vertices.size())},
                  {"edges", std::to_string(graph.edges.size())},
                  {"edges rejected", std::to_string(summary.rejected_edges.size())},
                  {"time", fixed(summary.seconds.total, 3) + " s"}};
  page.tables.push_back(
      {"Solution",
       "cost = 1/2 sum of r' information r, r the SE(3) logarithm of the residual "
       "pose; chi2 as g2o defines it.",
       {},
       {{"start", summary.initialisation},
        {"iterations", std::to_string(summary.iterations)},
        {"termination", summary.termination},
        {"chi2_g2o", general(summary.chi2_g2o)},
        {"components", std::to_string(summary.components)}}});
  PageTable rejected{"Edges rejected", "", {"from", "to"}, {}};
  for (const std::size_t k : summary.rejected_edges)
    rejected.rows.push_back(
        {std::to_string(graph.edges[k].from), std::to_string(graph.edges[k].to)});
  if (!rejected.rows.empty()) page.tables.push_back(std::move(rejected));
  PagePlot plan{"From above", "Vertices in their order.", "x [m]", "y [m]", false, {}};
  plan.plan = true;
  PagePlot::Series from{"before", "before", {}, {}};
  PagePlot::Series to{"after", "after", {}, {}};
  PagePlot::Series moved{"", "after", {}, {}};
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const Eigen::Vector3d& a = before[v].translation;
    const Eigen::Vector3d& b = graph.vertices[v].pose.translation;
    from.x.push_back(a.x());
    from.y.push_back(a.y());
    to.x.push_back(b.x());
    to.y.push_back(b.y());
    moved.x.push_back(static_cast<double>(v));
    moved.y.push_back((b - a).norm());
  }
  plan.series = {from, to};
  const PagePlot distance{"How far vertices moved", "", "vertex, in order", "[m]", true, {moved}};
  page.json["plots"] = {to_json(plan), to_json(distance)};
  return page;
}

}  // namespace groundloop::apps
