// checkpoint.bin of an unfinished session, behind a head that is right; a run goes on from it.
#include "backend/mapping/checkpoint.hpp"

#include <cstring>

#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/fuzz/targets/run_states.hpp"

GROUNDLOOP_FUZZ_TARGET(checkpoint) {
  const std::string body = std::string(text_of(input));
  const std::array<std::uint64_t, 2> head{kCheckpointMagic, checksum(std::string_view(body))};
  std::string text(reinterpret_cast<const char*>(head.data()), sizeof head);
  const SessionFolder folder(lay_out("unfinished", {}));
  (void)scratch_file("unfinished/checkpoint.bin", text + body);
  RunState state = small_run_state(folder);
  Checkpoint(folder, run_identity()).load(state, LoopClosureOptions{});
  go_on(state);
  Checkpoint(folder, run_identity()).save(state);
}
