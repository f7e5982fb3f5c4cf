// ROS 1 bags, whole and damaged, beside ground truth.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(rosbag) { read_recording(input, "rosbag"); }
