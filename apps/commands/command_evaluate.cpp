#include "apps/commands/commands.hpp"

namespace groundloop::apps {

void add_evaluate_command(CLI::App& app, Context& context) {
  CLI::App* group = app.add_subcommand("evaluate", "judge a trajectory, closures or a map");
  group->require_subcommand(1);
  add_evaluate_trajectory_command(*group, context);
  add_evaluate_closures_command(*group, context);
  add_evaluate_map_command(*group, context);
}

}  // namespace groundloop::apps
