// closures.csv and local_maps.csv; what is accepted is written and read again the same.
#include "backend/session/session.hpp"
#include "frontend/core/files.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace groundloop::fuzz {
static void read_closure_table(const std::filesystem::path& file) {
  const std::vector<ClosureRecord> closures = read_closures(file);
  const auto again = scratch_folder() / "again.csv";
  write_closures(again, closures);
  const std::string text = read_text(again);
  write_closures(again, read_closures(again));
  FUZZ_PROMISE(read_text(again) == text);
}
static void read_map_table(const std::filesystem::path& file) {
  const std::vector<LocalMapRecord> maps = read_local_maps(file);
  const auto again = scratch_folder() / "again.csv";
  write_local_maps(again, maps);
  const std::string text = read_text(again);
  write_local_maps(again, read_local_maps(again));
  FUZZ_PROMISE(read_text(again) == text);
}
}  // namespace groundloop::fuzz

GROUNDLOOP_FUZZ_TARGET(tables) {
  const auto file = scratch_file("table.csv", text_of(input));
  if (text_of(input).starts_with("map")) {
    read_map_table(file);
  } else {
    read_closure_table(file);
  }
}
