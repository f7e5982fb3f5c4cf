// groundloop_fuzz_replay TARGET FILE...      runs a target on files, e.g. on what a fuzzer found
// groundloop_fuzz_replay --seeds FOLDER      writes the inputs to start from to FOLDER/TARGET/
// groundloop_fuzz_replay --targets           names the targets
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "frontend/core/files.hpp"
#include "tests/fuzz/corpus.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

namespace fs = std::filesystem;
using namespace groundloop;

void write_seeds(const fs::path& folder) {
  for (const fuzz::Target& target : fuzz::targets()) {
    const fs::path of_target = folder / target.name;
    fs::create_directories(of_target);
    for (const fuzz::KeptInput& input : fuzz::corpus_of(target.name))
      std::ofstream(of_target / input.name, std::ios::binary) << input.content;
  }
}

void replay(const fuzz::Target& target, const fs::path& path) {
  if (fs::is_directory(path)) {
    for (const fs::path& file : list_files(path, "")) replay(target, file);
    return;
  }
  const std::string content = read_text(path);
  fuzz::run(target, std::as_bytes(std::span(content)));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  fuzz::set_up();
  if (word == "--targets") {
    for (const fuzz::Target& target : fuzz::targets()) std::printf("%s\n", target.name);
    return 0;
  }
  if (word == "--seeds" && argc == 3) {
    write_seeds(argv[2]);
    return 0;
  }
  for (const fuzz::Target& target : fuzz::targets()) {
    if (word != target.name) continue;
    for (int i = 2; i < argc; ++i) replay(target, argv[i]);
    return 0;
  }
  std::fprintf(stderr,
               "usage: groundloop_fuzz_replay TARGET FILE... | --seeds FOLDER | --targets\n");
  return 2;
}
