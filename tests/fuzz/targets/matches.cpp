// Files of `groundloop match`: the input as it is, and with a last line whose checksum is right.
#include "backend/merging/session_matching.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(matches) {
  try {
    (void)read_matches(scratch_file("matches.csv", text_of(input)));
  } catch (const InputError&) {
  }
  const std::string text(text_of(input));
  const auto file = scratch_file(
      "matches.csv", text + "# end " + std::to_string(checksum(std::string_view(text))) + "\n");
  const std::vector<PairMatches> pairs = read_matches(file);
  const auto again = scratch_folder() / "again.csv";
  write_matches(again, pairs);
  FUZZ_PROMISE(read_matches(again).size() == pairs.size());
}
