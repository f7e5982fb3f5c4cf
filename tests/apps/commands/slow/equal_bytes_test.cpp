// The same input, configuration and version give the same bytes, whatever the folder is called, how
// many threads there are, and how often the run was cut off: on recordings that close loops, within
// sessions and between them.
#include <random>

#include <gtest/gtest.h>

#include "backend/session/session.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "tests/support/process.hpp"
#include "tests/support/session_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::ProcessOptions;
using testing::run_process;
using testing::session_bytes;
using testing::TemporaryFolder;

int accepted(const fs::path& session, bool between) {
  int count = 0;
  for (const ClosureRecord& c : read_closures(session / "closures.csv")) {
    count +=
        c.status == ClosureStatus::accepted && (c.reference_session != c.query_session) == between
            ? 1
            : 0;
  }
  return count;
}

// Seven hundred metres of streets that meet again, on two days, written to disk once.
class EqualBytes : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    for (const int day : {0, 1}) {
      const auto recording = open_any_recording("sim:town?sensor=spin16&length=700&seed=5&change=" +
                                                std::to_string(day));
      write_layout(*recording, "folder", input(day));
      const auto result = run_process(run_arguments(day, session(day)), *folder_ / "log");
      ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    }
  }
  static void TearDownTestSuite() { delete folder_; }
  static fs::path input(int day) { return *folder_ / ("day" + std::to_string(day)); }
  static fs::path session(int day) { return *folder_ / ("session" + std::to_string(day)); }
  static std::vector<std::string> run_arguments(int day, const fs::path& out) {
    return {"--quiet",
            "run",
            input(day).string(),
            "--out",
            out.string(),
            "--set",
            "keeping.checkpoint_seconds=0.2"};
  }
  static std::vector<std::string> merge_arguments(const fs::path& out) {
    return {"--quiet", "merge", session(0).string(), session(1).string(), "--out", out.string()};
  }

  // Signals the command again and again, at random moments, until it has come to its end. Returns
  // how often it was cut off.
  int run_in_pieces(std::vector<std::string> arguments, int signal, unsigned seed, int longest_ms) {
    std::mt19937 generator(seed);
    const std::vector<std::string> first = arguments;
    arguments.emplace_back("--resume");
    int cut_off = 0;
    bool begun = false;
    while (cut_off < 200) {
      ProcessOptions options;
      options.signal = signal;
      options.signal_after =
          std::chrono::milliseconds(1 + generator() % static_cast<unsigned>(longest_ms));
      // What cannot get on between two signals is given more time.
      longest_ms += longest_ms / 20 + 1;
      const auto result = run_process(begun ? arguments : first, own_ / "log", options);
      if (result.exit_code == 0) return cut_off;
      EXPECT_TRUE(result.signal == signal || result.exit_code == 130) << result.standard_error;
      if (::testing::Test::HasFailure()) return cut_off;
      ++cut_off;
      begun = fs::exists(own_ / "out" / "manifest.json");
    }
    return cut_off;
  }

  static TemporaryFolder* folder_;
  TemporaryFolder own_;
};

TemporaryFolder* EqualBytes::folder_ = nullptr;

TEST_F(EqualBytes, OfARunWithAnyThreadsInAnyFolder) {
  EXPECT_GE(accepted(session(0), false), 2);
  const fs::path other = own_ / "another name" / "deeper";
  std::vector<std::string> arguments = run_arguments(0, other);
  arguments.insert(arguments.begin(), {"--threads", "1"});
  ASSERT_EQ(run_process(arguments, own_ / "log").exit_code, 0);
  EXPECT_EQ(session_bytes(other), session_bytes(session(0)));
}

TEST_F(EqualBytes, OfARunThatWasInterruptedAgainAndAgain) {
  EXPECT_GE(run_in_pieces(run_arguments(0, own_ / "out"), SIGINT, 1, 1500), 2);
  EXPECT_EQ(session_bytes(own_ / "out"), session_bytes(session(0)));
}

TEST_F(EqualBytes, OfARunThatWasKilledAgainAndAgain) {
  EXPECT_GE(run_in_pieces(run_arguments(0, own_ / "out"), SIGKILL, 2, 1500), 2);
  EXPECT_EQ(session_bytes(own_ / "out"), session_bytes(session(0)));
}

// A file system that is really full, where this machine lets one be made; then with room again.
TEST_F(EqualBytes, OfARunWhoseDiskWasFull) {
  const fs::path disk = own_ / "disk";
  fs::create_directories(disk);
  const auto mount = [&](const std::string& how) {
    return std::system(
        ("mount -t tmpfs -o " + how + " tmpfs '" + disk.string() + "' 2>/dev/null").c_str());
  };
  std::uintmax_t whole = 0;
  for (const auto& entry : fs::recursive_directory_iterator(session(0)))
    whole += entry.is_regular_file() ? entry.file_size() : 0;
  int refused = 0;
  for (const double share : {0.3, 0.6, 0.9}) {
    const auto bytes = static_cast<std::uintmax_t>(share * static_cast<double>(whole));
    if (mount("size=" + std::to_string(std::max<std::uintmax_t>(bytes, 21'000'000))) != 0)
      GTEST_SKIP() << "file systems cannot be mounted here";
    std::vector<std::string> arguments = run_arguments(0, disk / "out");
    const auto result = run_process(arguments, own_ / "log");
    if (result.exit_code != 0) {
      EXPECT_EQ(result.exit_code, 2) << result.standard_error;
      EXPECT_NE(result.standard_error.find("make room on the disk"), std::string::npos)
          << result.standard_error;
      ++refused;
      EXPECT_EQ(mount("remount,size=1g"), 0);
      arguments.emplace_back("--resume");
      if (!fs::exists(disk / "out" / "manifest.json")) arguments.pop_back();
      const auto again = run_process(arguments, own_ / "log");
      EXPECT_EQ(again.exit_code, 0) << again.standard_error;
    }
    EXPECT_EQ(session_bytes(disk / "out"), session_bytes(session(0)));
    EXPECT_EQ(std::system(("umount '" + disk.string() + "'").c_str()), 0);
  }
  EXPECT_GE(refused, 1);
}

TEST_F(EqualBytes, OfAMergeWithAnyThreadsInAnyFolder) {
  ASSERT_EQ(run_process(merge_arguments(own_ / "a"), own_ / "log").exit_code, 0);
  EXPECT_GE(accepted(own_ / "a", true), 2);
  std::vector<std::string> arguments = merge_arguments(own_ / "quite another");
  arguments.insert(arguments.begin(), {"--threads", "1"});
  ASSERT_EQ(run_process(arguments, own_ / "log").exit_code, 0);
  EXPECT_EQ(session_bytes(own_ / "a"), session_bytes(own_ / "quite another"));
}

TEST_F(EqualBytes, OfAMergeThatWasKilledAgainAndAgain) {
  ASSERT_EQ(run_process(merge_arguments(own_ / "whole"), own_ / "log").exit_code, 0);
  EXPECT_GE(run_in_pieces(merge_arguments(own_ / "out"), SIGKILL, 3, 300), 1);
  EXPECT_EQ(session_bytes(own_ / "whole"), session_bytes(own_ / "out"));
}

}  // namespace
}  // namespace groundloop
