// KITTI odometry: scans, times, times of points, calibration and poses.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(kitti) { read_recording(input, "kitti"); }
