// Configuration as YAML; what is accepted is written out and read again the same.
#include "apps/config/config.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(configuration) {
  const auto file = scratch_file("config.yaml", text_of(input));
  const apps::Config config = apps::effective_config(file.string(), {});
  apps::validate_config(config);
  const std::string text = apps::to_yaml(config);
  const auto again = scratch_file("again.yaml", text);
  FUZZ_PROMISE(apps::to_yaml(apps::effective_config(again.string(), {})) == text);
}
