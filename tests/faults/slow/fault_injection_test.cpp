// Every operation on the disk of small but complete commands fails once, or the process is killed
// before it. Nothing is lost, nothing half-written is seen, and what goes on afterwards ends in the
// bytes of an undisturbed run. GROUNDLOOP_FAULT_STRIDE=1 injects into every operation; tests take
// every few.
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "tests/faults/fault_series.hpp"
#include "tests/support/session_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::FaultedCommand;
using testing::run_process;
using testing::session_bytes;
using testing::TemporaryFolder;

long stride(long usual) {
  const char* given = std::getenv("GROUNDLOOP_FAULT_STRIDE");
  return given == nullptr ? usual : std::max(1L, std::atol(given));
}

// Two days of a short way, written once, and sessions of both.
class Faults : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    for (const int day : {0, 1}) {
      RecordingOptions options;
      options.count = 24;
      const auto recording = open_any_recording(
          "sim:town?sensor=spin16&length=60&seed=3&change=" + std::to_string(day), options);
      write_layout(*recording, "folder", input(day));
      ASSERT_EQ(run_process(run_arguments(day, session(day)), *folder_ / "log").exit_code, 0);
    }
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path input(int day) { return *folder_ / ("day" + std::to_string(day)); }
  static fs::path session(int day) { return *folder_ / ("session" + std::to_string(day)); }
  // Short local maps and a checkpoint a scan: many operations in little time.
  static std::vector<std::string> run_arguments(int day, const fs::path& out) {
    return {"--quiet",
            "run",
            input(day).string(),
            "--out",
            out.string(),
            "--set",
            "local_maps.max_scans=6",
            "--set",
            "keeping.checkpoint_seconds=0",
            "--set",
            "map.voxel_size=0.5"};
  }

  FaultedCommand command(const std::string& name, std::vector<std::string> arguments,
                         const fs::path& out, const std::string& again_with) {
    FaultedCommand command;
    command.name = name;
    command.root = root_;
    command.out = out;
    command.arguments = arguments;
    command.reset = [this] {
      fs::remove_all(root_);
      fs::create_directories(root_);
    };
    // Where nothing was begun there is nothing to resume; where all was done it is said.
    command.again = [arguments, out, again_with] {
      std::vector<std::string> words = arguments;
      if (!again_with.empty() && fs::exists(out / "manifest.json")) words.push_back(again_with);
      return words;
    };
    command.bytes = [out]() -> std::map<std::string, std::uint64_t> {
      if (fs::is_directory(out)) return session_bytes(out);
      return {{out.filename().string(), checksum_of_file(out)}};
    };
    return command;
  }

  void inject(const FaultedCommand& command, long usual_stride) {
    const std::map<std::string, long> operations = testing::count_operations(command);
    const std::vector<std::pair<const char*, const char*>> kinds{
        {"open", "EACCES"},  {"write", "ENOSPC"},  {"write", "EIO"},
        {"fsync", "EIO"},    {"rename", "EACCES"}, {"link", "EIO"},
        {"mkdir", "EACCES"}, {"unlink", "EACCES"}, {"any", "kill"}};
    for (const auto& [kind, fault] : kinds) {
      const testing::SeriesCounts counts =
          testing::run_series(command, kind, operations.at(kind), fault, stride(usual_stride));
      std::printf("| %s | %s %s | %ld | %d | %d | %d | %d |\n", command.name.c_str(), kind, fault,
                  operations.at(kind), counts.injected, counts.refused, counts.survived,
                  counts.killed);
      if (HasFailure()) return;
    }
  }

  static TemporaryFolder* folder_;
  TemporaryFolder own_;
  fs::path root_ = own_ / "root";
};

TemporaryFolder* Faults::folder_ = nullptr;

TEST_F(Faults, OfARun) {
  inject(command("run", run_arguments(0, root_ / "out"), root_ / "out", "--resume"), 23);
}

TEST_F(Faults, OfAMerge) {
  inject(command("merge",
                 {"--quiet", "merge", session(0).string(), session(1).string(), "--out",
                  (root_ / "out").string()},
                 root_ / "out", "--resume"),
         11);
}

TEST_F(Faults, OfAMatch) {
  inject(command("match",
                 {"--quiet", "match", session(0).string(), session(1).string(), "--out",
                  (root_ / "out.csv").string()},
                 root_ / "out.csv", ""),
         1);
}

TEST_F(Faults, OfAnExport) {
  for (const char* name : {"out.pcd", "out.las"}) {
    inject(command("export",
                   {"--quiet", "export", session(0).string(), "--out", (root_ / name).string()},
                   root_ / name, ""),
           1);
  }
}

TEST_F(Faults, OfAnOptimisation) {
  inject(command("optimize",
                 {"--quiet", "optimize", (session(0) / "pose_graph.g2o").string(), "--out",
                  (root_ / "out.g2o").string()},
                 root_ / "out.g2o", ""),
         1);
}

// The old session stays until the new one is complete, and one of the two is always there whole.
TEST_F(Faults, OfAReplacement) {
  std::vector<std::string> arguments = run_arguments(1, root_ / "out");
  arguments.emplace_back("--overwrite");
  FaultedCommand replacing = command("run --overwrite", arguments, root_ / "out", "");
  const auto old_bytes = session_bytes(session(0));
  replacing.reset = [this] {
    fs::remove_all(root_);
    fs::create_directories(root_);
    fs::copy(session(0), root_ / "out", fs::copy_options::recursive);
    write_text_atomically(root_ / "out" / "notes.txt", "a user's own");
  };
  const std::map<std::string, long> operations = testing::count_operations(replacing);
  auto new_bytes = session_bytes(root_ / "out");
  EXPECT_EQ(new_bytes.count("notes.txt"), 1U);
  int injected = 0;
  for (const auto& [kind, fault] : std::vector<std::pair<const char*, const char*>>{
           {"any", "kill"}, {"rename", "EACCES"}, {"write", "ENOSPC"}, {"unlink", "EACCES"}}) {
    // The last operations are those of the replacement: all of them, and some before.
    const long last = operations.at(kind);
    for (long n = 1; n <= last; n += n < last - 60 ? stride(41) : 1) {
      const std::string what = std::string(kind) + ":" + std::to_string(n) + ":" + fault;
      SCOPED_TRACE(what);
      replacing.reset();
      testing::ProcessOptions options;
      options.environment = {{"LD_PRELOAD", GROUNDLOOP_FAULT_LIBRARY},
                             {"GROUNDLOOP_FAULT_ROOT", root_.string()},
                             {"GROUNDLOOP_FAULT", what}};
      const auto result = run_process(arguments, own_ / "log", options);
      ++injected;
      EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 2 || result.signal == SIGKILL)
          << result.standard_error;
      auto bytes = session_bytes(root_ / "out");
      bytes.erase("notes.txt");
      // Where they cannot be removed these stay until the next run.
      bytes.erase(".groundloop-replacement");
      bytes.erase("checkpoint.bin");
      auto expected_new = new_bytes;
      expected_new.erase("notes.txt");
      EXPECT_TRUE(bytes == old_bytes || bytes == expected_new) << result.standard_error;
      std::vector<std::string> again = arguments;
      again.emplace_back("--resume");
      const auto second = run_process(again, own_ / "log");
      EXPECT_EQ(second.exit_code, 0) << second.standard_error;
      EXPECT_EQ(session_bytes(root_ / "out"), new_bytes) << result.standard_error;
      EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);
      if (HasFailure()) return;
    }
  }
  std::printf("| run --overwrite | kill, rename, write, unlink | %d |\n", injected);
}

// Memory that runs out, at large allocations all along the way.
TEST_F(Faults, OfMemory) {
  const FaultedCommand run =
      command("run", run_arguments(0, root_ / "out"), root_ / "out", "--resume");
  const long allocations = testing::count_operations(run).at("alloc");
  const testing::SeriesCounts counts = testing::run_series(run, "alloc", allocations, "ENOMEM",
                                                           stride(std::max(1L, allocations / 40)));
  std::printf("| run | alloc | %ld | %d | %d | %d | %d |\n", allocations, counts.injected,
              counts.refused, counts.survived, counts.killed);
}

}  // namespace
}  // namespace groundloop
