// ROS 2 bags: metadata.yaml, sqlite3 and MCAP files, compressed by file or message.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(rosbag2) { read_recording(input, "rosbag2"); }
