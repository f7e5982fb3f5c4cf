#include "tests/fuzz/targets/sessions.hpp"

#include <fstream>

#include <nlohmann/json.hpp>

#include "frontend/core/checksum.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace groundloop::fuzz {
namespace fs = std::filesystem;

fs::path lay_out_session(const char* name, std::string_view bundle) {
  const NamedContents files = split_bundle(bundle);
  const fs::path folder = lay_out(name, files);
  for (const auto& [file, content] : files) {
    if (file != "manifest.json") continue;
    nlohmann::ordered_json manifest = nlohmann::ordered_json::parse(content, nullptr, false);
    if (!manifest.is_object() || !manifest.contains("checksums") ||
        !manifest["checksums"].is_object())
      continue;
    for (auto& [of, sum] : manifest["checksums"].items()) {
      for (const auto& [other, bytes] : files) {
        if (other == of) sum = hex(checksum(bytes));
      }
    }
    // Text that is no UTF-8 stays as it was.
    try {
      std::ofstream(folder / file) << manifest.dump();
    } catch (const nlohmann::ordered_json::exception&) {
    }
  }
  return folder;
}

}  // namespace groundloop::fuzz
