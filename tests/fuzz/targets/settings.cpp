// Settings KEY=VALUE of the command line, one a line.
#include <sstream>

#include "apps/config/config.hpp"
#include "tests/fuzz/fuzz_target.hpp"

GROUNDLOOP_FUZZ_TARGET(settings) {
  std::istringstream text{std::string(text_of(input))};
  std::vector<std::string> settings;
  for (std::string line; std::getline(text, line);) settings.push_back(line);
  const apps::Config config = apps::effective_config("", settings);
  apps::validate_config(config);
  FUZZ_PROMISE(!apps::to_yaml(config).empty());
}
