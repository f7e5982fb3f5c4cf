// Suites of benchmarks as YAML.
#include "apps/benchmark/suite.hpp"

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(suite) {
  const apps::Suite suite = apps::read_suite(scratch_file("suite.yaml", text_of(input)).string());
  for (const apps::SuiteRecording& recording : suite.recordings)
    FUZZ_PROMISE(!recording.name.empty());
}
