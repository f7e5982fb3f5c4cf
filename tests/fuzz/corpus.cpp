#include "tests/fuzz/corpus.hpp"

#include <filesystem>

#include "frontend/core/files.hpp"
#include "tests/fuzz/seeds.hpp"

namespace groundloop::fuzz {

std::vector<KeptInput> corpus_of(const std::string& target) {
  std::vector<KeptInput> inputs;
  for (std::string& seed : made_seeds(target))
    inputs.push_back({"made-" + std::to_string(inputs.size()), std::move(seed), true});
  const std::filesystem::path folder = std::filesystem::path(GROUNDLOOP_FUZZ_CORPUS) / target;
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return inputs;
  for (const std::filesystem::path& file : list_files(folder, "")) {
    const std::string name = file.filename().string();
    inputs.push_back({name, read_text(file), name.rfind("valid", 0) == 0});
  }
  return inputs;
}

}  // namespace groundloop::fuzz
