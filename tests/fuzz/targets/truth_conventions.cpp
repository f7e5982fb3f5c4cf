// Ground truth of data sets beside scans: Boreas, Newer College, Oxford Spires.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(truth_conventions) { read_recording(input, "folder"); }
