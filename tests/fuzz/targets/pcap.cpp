// Captures of packets, whole and damaged, beside an Ouster sensor's metadata.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/recordings.hpp"

GROUNDLOOP_FUZZ_TARGET(pcap) { read_recording(input, "pcap"); }
