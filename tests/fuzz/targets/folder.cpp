// Folders of headerless, PCD and PLY scans, with times.txt or stamps in their names.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(folder) { read_recording(input, "folder"); }
