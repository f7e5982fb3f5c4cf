#include "tests/faults/fault_series.hpp"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "frontend/core/checksum.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::testing {
namespace fs = std::filesystem;

namespace {

fs::path log_of(const FaultedCommand& command) { return fs::path(command.root.string() + ".log"); }

ProcessResult run_faulted(const FaultedCommand& command, const std::string& fault) {
  ProcessOptions options;
  options.environment = {{"LD_PRELOAD", GROUNDLOOP_FAULT_LIBRARY},
                         {"GROUNDLOOP_FAULT_ROOT", command.root.string()},
                         {"GROUNDLOOP_FAULT", fault}};
  return run_process(command.arguments, log_of(command), options);
}

// What stands under a final name is whole: the very file of an undisturbed run. Files that tell of
// a run's course, and those that are hidden, are other ones.
void expect_whole_files(const FaultedCommand& command,
                        const std::map<std::string, std::uint64_t>& undisturbed) {
  if (!fs::is_directory(command.out)) {
    if (fs::exists(command.out)) {
      const auto file = undisturbed.find(command.out.filename().string());
      ASSERT_NE(file, undisturbed.end());
      EXPECT_EQ(checksum_of_file(command.out), file->second) << command.out;
    }
    return;
  }
  for (const auto& entry : fs::recursive_directory_iterator(command.out)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), command.out).string();
    const auto file = undisturbed.find(name);
    if (file == undisturbed.end() || name == "manifest.json") continue;
    EXPECT_EQ(checksum_of_file(entry.path()), file->second) << name;
  }
}

void expect_one_line(const std::string& text) {
  const std::size_t at = text.rfind("groundloop: ");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_EQ(text.find('\n', at), text.size() - 1) << text;
}

}  // namespace

std::map<std::string, long> count_operations(const FaultedCommand& command) {
  command.reset();
  const fs::path counts = command.root.string() + ".counts";
  ProcessOptions options;
  options.environment = {{"LD_PRELOAD", GROUNDLOOP_FAULT_LIBRARY},
                         {"GROUNDLOOP_FAULT_ROOT", command.root.string()},
                         {"GROUNDLOOP_FAULT_COUNTS", counts.string()}};
  const ProcessResult result = run_process(command.arguments, log_of(command), options);
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  std::map<std::string, long> operations;
  std::istringstream text(read_text(counts));
  std::string kind;
  long count = 0;
  while (text >> kind >> count) operations[kind] = count;
  return operations;
}

SeriesCounts run_series(const FaultedCommand& command, const std::string& kind, long operations,
                        const std::string& fault, long stride) {
  SeriesCounts counts;
  command.reset();
  const ProcessResult whole = run_process(command.arguments, log_of(command));
  EXPECT_EQ(whole.exit_code, 0) << whole.standard_error;
  const std::map<std::string, std::uint64_t> undisturbed = command.bytes();
  for (long n = 1; n <= operations; n += stride) {
    const std::string what = kind + ":" + std::to_string(n) + ":" + fault;
    SCOPED_TRACE(command.name + " " + what);
    command.reset();
    const ProcessResult result = run_faulted(command, what);
    ++counts.injected;
    if (result.signal != 0) {
      EXPECT_EQ(result.signal, SIGKILL) << "crashed: " << result.standard_error;
      EXPECT_EQ(fault, "kill") << result.standard_error;
      ++counts.killed;
    } else if (result.exit_code == 0) {
      ++counts.survived;
    } else {
      EXPECT_EQ(result.exit_code, 2) << result.standard_error;
      expect_one_line(result.standard_error);
      ++counts.refused;
    }
    expect_whole_files(command, undisturbed);
    ProcessResult again = run_process(command.again(), log_of(command));
    EXPECT_EQ(again.exit_code, 0) << again.standard_error << "\nafter " << result.standard_error;
    EXPECT_EQ(command.bytes(), undisturbed);
    if (::testing::Test::HasFailure()) break;  // the first tells most
  }
  return counts;
}

}  // namespace groundloop::testing
