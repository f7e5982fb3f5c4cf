// `groundloop compare A B`: what two sessions have in common and where they differ: figures,
// trajectory, closures, configuration; as a table, and as a page with --out.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/commands/commands.hpp"
#include "apps/commands/ground_truth.hpp"
#include "apps/report/html_page.hpp"
#include "apps/report/session_comparison.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  std::string a, b, out;
};

void print(const PageTable& table) {
  std::printf("%s\n", table.title.c_str());
  if (table.rows.empty()) std::printf("  %s\n", table.note.c_str());
  const auto line = [](const std::vector<std::string>& cells) {
    std::printf("  %-34s", cells.empty() ? "" : cells.front().c_str());
    for (std::size_t i = 1; i < cells.size(); ++i) std::printf(" %18s", cells[i].c_str());
    std::printf("\n");
  };
  if (table.rows.empty()) return;
  line(table.columns);
  for (const std::vector<std::string>& row : table.rows) {
    line(row);
  }
}

void run(const Arguments& arguments) {
  const SessionContents a = read_session_contents(arguments.a);
  const SessionContents b = read_session_contents(arguments.b);
  const Page page =
      compare_sessions(a, true_trajectories(a.session), b, true_trajectories(b.session));
  if (arguments.out.empty()) {
    for (const PageTable& table : page.tables) print(table);
    return;
  }
  write_text_atomically(arguments.out, make_page(page));
  spdlog::info("comparison: {}", arguments.out);
}

}  // namespace

void add_compare_command(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand(
      "compare", "what differs between two sessions: figures, trajectory, closures, options");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("A", arguments->a, "session folder")->required();
  command->add_option("B", arguments->b, "session folder")->required();
  command->add_option("--out", arguments->out, "page to write (.html) instead of tables");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace groundloop::apps
