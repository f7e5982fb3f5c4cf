// Stamps in text files and file names, and what is made of them. The first lines are names of scan
// files up to an empty line, the rest is times.txt.
#include <sstream>

#include "frontend/recordings/source_tools.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(stamps) {
  std::istringstream text{std::string(text_of(input))};
  std::vector<std::filesystem::path> files;
  std::string line;
  while (std::getline(text, line) && !line.empty()) {
    if (line.find('\0') == std::string::npos && line.find('/') == std::string::npos)
      files.emplace_back(line);
  }
  std::vector<std::filesystem::path> by_name = files;
  if (!files.empty()) {
    if (const auto named = recordings::stamps_from_names(by_name)) {
      FUZZ_PROMISE(named->stamps.size() == files.size());
      for (const Nanoseconds stamp : named->stamps) FUZZ_PROMISE(is_stamp(stamp));
      (void)recordings::scan_duration(named->stamps);
      (void)recordings::count_gaps(named->stamps);
    }
  }
  std::string rest;
  std::getline(text, rest, '\0');
  const auto file = scratch_file("times.txt", rest);
  const std::vector<Nanoseconds> stamps = recordings::read_stamp_file(file);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    FUZZ_PROMISE(is_stamp(stamps[i]));
    FUZZ_PROMISE(i == 0 || stamps[i - 1] < stamps[i]);
  }
  (void)recordings::median_period(stamps);
  (void)recordings::scan_duration(stamps);
  (void)recordings::count_gaps(stamps);
  const auto matched = recordings::match_stamps(files, file, stamps);
  FUZZ_PROMISE(matched.stamps.size() == files.size());
}
