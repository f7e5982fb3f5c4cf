// Files for readers that take paths. An input that stands for several files is written as text,
//
//   @@ sequences/00/times.txt
//   0.0
//   0.1
//   @@ sequences/00/velodyne/000000.bin
//   ...
//
// so that the fuzzer changes names and contents alike: a line that begins with "@@ " begins a file,
// whose content ends before the line break before the next such line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/fuzz/fuzz_target.hpp"

namespace groundloop::fuzz {

/// A folder in memory (/dev/shm, else the folder of temporary files) that goes with the process.
[[nodiscard]] const std::filesystem::path& scratch_folder();

/// Writes one file there, in place of what was there, and returns its path.
[[nodiscard]] std::filesystem::path scratch_file(const std::string& name, std::string_view content);

using NamedContents = std::vector<std::pair<std::string, std::string_view>>;

/// The files of an input. Names that would leave the folder, and more than 64 files, are left out.
[[nodiscard]] NamedContents split_bundle(std::string_view text);
[[nodiscard]] std::string join_bundle(
    const std::vector<std::pair<std::string, std::string>>& files);

/// Makes the folder `name` below the scratch folder hold exactly these files, and returns it.
[[nodiscard]] std::filesystem::path lay_out(const std::string& name, const NamedContents& files);

}  // namespace groundloop::fuzz
