// MCAP files, with and without a summary.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(mcap) { read_recording(input, "mcap"); }
