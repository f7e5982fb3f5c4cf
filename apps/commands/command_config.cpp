#include <cstdio>
#include <memory>

#include "apps/commands/commands.hpp"
#include "apps/config/config.hpp"

namespace groundloop::apps {

void add_config_command(CLI::App& app, Context&) {
  CLI::App* command =
      app.add_subcommand("config", "print the configuration of a preset, with units and reasons");
  auto preset = std::make_shared<std::string>("default");
  std::string names;
  for (const std::string& name : preset_names()) names += (names.empty() ? "" : ", ") + name;
  command->add_option("PRESET", *preset, "one of " + names + ", or a file");
  command->callback([preset] {
    Config config;
    read_config(config, *preset);
    validate_config(config);
    std::fputs(to_yaml(config).c_str(), stdout);
  });
}

}  // namespace groundloop::apps
