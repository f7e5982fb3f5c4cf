#include <malloc.h>

#include "apps/commands/commands.hpp"

int main(int argc, char** argv) {
  // Buffers of a megabyte and more (scans, maps, search structures) go back to the system when they
  // are freed. By default the threshold grows with each that is, and the heap is left full of
  // holes: a run over the real drive peaked a third higher.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  return groundloop::apps::run_command_line(argc, argv);
}
