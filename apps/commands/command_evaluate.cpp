#include "apps/commands/commands.hpp"

namespace groundloop::apps {

void add_evaluate_command(CLI::App& app, Context& context) {
  CLI::App* group =
      app.add_subcommand("evaluate", "compare a trajectory or closures with a reference");
  group->require_subcommand(1);
  add_evaluate_trajectory_command(*group, context);
  add_evaluate_closures_command(*group, context);
}

}  // namespace groundloop::apps
