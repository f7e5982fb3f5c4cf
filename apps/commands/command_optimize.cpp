// `groundloop optimize GRAPH.g2o --out OUT.g2o`: any SE(3) graph, optimised.
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "apps/commands/commands.hpp"
#include "apps/report/evaluation_pages.hpp"
#include "backend/graph/g2o_file.hpp"
#include "backend/judging/optimizer.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

struct OptimizeArguments {
  std::string graph;
  std::string out;
  std::string report;
  bool json = false;
  OptimizerOptions options;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

nlohmann::ordered_json to_json(const G2oFile& file, const OptimizationSummary& summary,
                               double read_seconds, double write_seconds) {
  nlohmann::ordered_json rejected = nlohmann::ordered_json::array();
  for (const std::size_t k : summary.rejected_edges) {
    rejected.push_back({file.graph.edges[k].from, file.graph.edges[k].to});
  }
  return {{"vertices", file.graph.vertices.size()},
          {"edges", file.graph.edges.size()},
          {"components", summary.components},
          {"initialisation", summary.initialisation},
          {"cost", {{"before", summary.cost_before}, {"after", summary.cost_after}}},
          {"chi2_g2o", summary.chi2_g2o},
          {"iterations", summary.iterations},
          {"converged", summary.converged},
          {"termination", summary.termination},
          {"seconds",
           {{"read", read_seconds},
            {"initialisation", summary.seconds.initialisation},
            {"robust", summary.seconds.robust},
            {"solve", summary.seconds.solve},
            {"write", write_seconds},
            {"total", read_seconds + summary.seconds.total + write_seconds}}},
          {"edges_rejected", summary.rejected_edges.size()},
          {"rejected", rejected},
          {"unknown_tags", file.unknown_tags}};
}

void print_table(const G2oFile& file, const OptimizationSummary& summary) {
  std::printf("vertices        %zu in %d component%s\n", file.graph.vertices.size(),
              summary.components, summary.components == 1 ? "" : "s");
  std::printf("edges           %zu, %zu rejected\n", file.graph.edges.size(),
              summary.rejected_edges.size());
  std::printf("cost            %.6g -> %.6g\n", summary.cost_before, summary.cost_after);
  std::printf("chi2_g2o        %.6g\n", summary.chi2_g2o);
  std::printf("start           %s\n", summary.initialisation.c_str());
  std::printf("iterations      %d (%s)\n", summary.iterations, summary.termination.c_str());
  std::printf("seconds         %.3f (initialisation %.3f, robust %.3f, solve %.3f)\n",
              summary.seconds.total, summary.seconds.initialisation, summary.seconds.robust,
              summary.seconds.solve);
}

void optimize_file(const OptimizeArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  G2oFile file = read_g2o(arguments.graph);
  for (const auto& [tag, count] : file.unknown_tags) {
    spdlog::warn("{}: {} line{} of unknown tag {} left out", arguments.graph, count,
                 count == 1 ? "" : "s", tag);
  }
  const double read_seconds = seconds_since(start);
  std::vector<Pose> before;
  for (const GraphVertex& vertex : file.graph.vertices) before.push_back(vertex.pose);
  const OptimizationSummary summary = optimize(file.graph, arguments.options);
  const auto write_start = std::chrono::steady_clock::now();
  write_g2o(arguments.out, file.graph);
  const double write_seconds = seconds_since(write_start);
  if (!arguments.report.empty()) {
    write_text_atomically(arguments.report,
                          make_page(graph_page(arguments.graph, before, file.graph, summary)));
  }
  if (arguments.json) {
    std::printf("%s\n", to_json(file, summary, read_seconds, write_seconds).dump(2).c_str());
  } else {
    print_table(file, summary);
  }
}

}  // namespace

void add_optimize_command(CLI::App& app, Context&) {
  auto arguments = std::make_shared<OptimizeArguments>();
  CLI::App* command = app.add_subcommand("optimize", "optimise an SE(3) pose graph in g2o format");
  command->add_option("GRAPH", arguments->graph, "graph to read (.g2o)")->required();
  command->add_option("--out", arguments->out, "graph to write")->required();
  command->add_flag("--robust", arguments->options.robust,
                    "trust edges between successive ids, judge the others");
  command->add_option("--initialisation", arguments->options.initialisation,
                      "auto, guess or chordal");
  command->add_flag("--json", arguments->json, "print the summary as one JSON object");
  command->add_option("--report", arguments->report, "page to write (.html)");
  command->callback([arguments] { optimize_file(*arguments); });
}

}  // namespace groundloop::apps
