// HeLiPR: records of four sensors and their ground truth.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(helipr) { read_recording(input, "helipr"); }
