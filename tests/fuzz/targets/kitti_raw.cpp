// KITTI raw: scans, three files of dates, GPS/IMU packets and their calibration.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(kitti_raw) { read_recording(input, "kitti_raw"); }
