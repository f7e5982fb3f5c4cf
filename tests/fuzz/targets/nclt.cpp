// NCLT: packets or scans, and ground truth.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(nclt) { read_recording(input, "nclt"); }
