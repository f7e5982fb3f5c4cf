// loop_database.bin: the input as it is, and as the body of a file whose checksum is right. Every
// map of what is accepted is looked for in it.
#include "loopclosure/loop_database.hpp"

#include <cstring>

#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "tests/fuzz/fuzz_target.hpp"

GROUNDLOOP_FUZZ_TARGET(loop_database) {
  const LoopClosureOptions options;
  try {
    (void)LoopDatabase::from_bytes(input, "input", options);
  } catch (const InputError&) {
  }
  std::vector<std::byte> bytes(input.begin(), input.end());
  const std::uint64_t sum = checksum(input);
  const auto* at = reinterpret_cast<const std::byte*>(&sum);
  bytes.insert(bytes.end(), at, at + sizeof sum);
  const LoopDatabase database = LoopDatabase::from_bytes(bytes, "input", options);
  FUZZ_PROMISE(database.bytes() == bytes);
  for (const MapDescription& description : database.descriptions()) {
    for (const ClosureCandidate& candidate : database.query(description)) {
      FUZZ_PROMISE(candidate.T_query_reference.translation.allFinite());
    }
  }
}
