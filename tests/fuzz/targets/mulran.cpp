// MulRan: scans and global_pose.csv.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(mulran) { read_recording(input, "mulran"); }
