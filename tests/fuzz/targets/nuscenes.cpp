// nuScenes: the tables in JSON, and the scans that they name.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(nuscenes) { read_recording(input, "nuscenes"); }
