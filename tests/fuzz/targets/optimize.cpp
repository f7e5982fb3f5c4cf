// Small pose graphs through `groundloop optimize`, with and without judging; the result is a graph.
#include <algorithm>
#include <filesystem>

#include "backend/graph/g2o_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/fuzz/targets/commands.hpp"

GROUNDLOOP_FUZZ_TARGET(optimize) {
  if (std::count(input.begin(), input.end(), std::byte{'\n'}) > 60) return;
  const std::string file = scratch_file("graph.g2o", text_of(input)).string();
  const auto out = scratch_folder() / "optimized.g2o";
  std::filesystem::remove(out);
  const bool plain = command({"optimize", file, "--out", out.string(), "--json"});
  if (plain) (void)read_g2o(out);
  if (plain && command({"optimize", file, "--out", out.string(), "--robust", "--json"}))
    (void)read_g2o(out);
}
