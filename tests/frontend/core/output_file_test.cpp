#include "frontend/core/output_file.hpp"

#include <csignal>
#include <cstring>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

// Runs `child` in a process of its own, which ends by SIGKILL.
template <typename F>
void in_killed_process(F&& child) {
  const pid_t pid = fork();
  if (pid == 0) {
    child();
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST(OutputFile, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  { OutputFile(folder / "a.txt").write("half"); }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(OutputFile, ANameWithoutAFolderIsOneInTheCurrentFolder) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  EXPECT_NO_THROW(write_text_atomically("a.txt", "text"));
  fs::current_path(before);
  EXPECT_EQ(read_text(folder / "a.txt"), "text");
}

TEST(OutputFile, HoldsWhatWasWrittenAndNothingElseStays) {
  const TemporaryFolder folder;
  std::string text;
  {
    OutputFile file(folder / "deep" / "a.txt");
    file.write("head....");
    for (int i = 0; i < 100'000; ++i) {
      text += std::to_string(i);
      file.write(std::to_string(i));
    }
    file.write_at_start("HEAD");
    file.write("end");
    file.commit();
  }
  EXPECT_EQ(read_text(folder / "deep" / "a.txt"), "HEAD...." + text + "end");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "deep"), {}), 1);
}

TEST(OutputFile, TheOldFileStaysUntilCommit) {
  const TemporaryFolder folder;
  write_text_atomically(folder / "a.txt", "old");
  OutputFile file(folder / "a.txt");
  file.write("new");
  EXPECT_EQ(read_text(folder / "a.txt"), "old");
  file.commit();
  EXPECT_EQ(read_text(folder / "a.txt"), "new");
}

TEST(OutputFile, AKilledWritersLeftoverIsTakenOver) {
  const TemporaryFolder folder;
  const fs::path name = folder / "a.txt";
  in_killed_process([&] {
    auto* leaked = new OutputFile(name);
    leaked->write(std::string(1 << 20, 'x'));
  });
  EXPECT_FALSE(fs::exists(name));
  EXPECT_TRUE(fs::exists(OutputFile::temporary_name(name)));
  write_text_atomically(name, "whole");
  EXPECT_EQ(read_text(name), "whole");
  EXPECT_FALSE(fs::exists(OutputFile::temporary_name(name)));
}

TEST(OutputFile, TwoWritersOfOneFileDoNotMix) {
  const TemporaryFolder folder;
  OutputFile first(folder / "a.txt");
  try {
    OutputFile second(folder / "a.txt");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::strstr(e.what(), "another process"), nullptr);
  }
  first.write("first");
  first.commit();
  EXPECT_EQ(read_text(folder / "a.txt"), "first");
}

TEST(OutputFile, ALinkInTheTemporaryNamesPlaceIsNotFollowed) {
  const TemporaryFolder folder;
  write_text_atomically(folder / "precious", "kept");
  fs::create_symlink("precious", OutputFile::temporary_name(folder / "a.txt"));
  EXPECT_THROW(write_text_atomically(folder / "a.txt", "new"), InputError);
  EXPECT_EQ(read_text(folder / "precious"), "kept");
}

TEST(OutputFile, AFullDiskIsNamedWithItsRemedy) {
  EXPECT_NE(write_error_text(ENOSPC).find("make room"), std::string::npos);
}

TEST(OutputFile, AFolderIsNoFile) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "a");
  EXPECT_THROW(OutputFile(folder / "a"), InputError);
  EXPECT_THROW(OutputFile("/proc/nowhere/a"), InputError);
}

TEST(ScratchFile, GivesBackWhatWasAppendedAndHasNoName) {
  const TemporaryFolder folder;
  ScratchFile file(folder.path());
  const std::string text = "abcdefgh";
  EXPECT_EQ(file.append(std::as_bytes(std::span(text))), 0U);
  EXPECT_EQ(file.append(std::as_bytes(std::span(text))), 8U);
  EXPECT_TRUE(fs::is_empty(folder.path()));
  std::string back(4, ' ');
  file.read(6, std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, "ghab");
  EXPECT_THROW(file.read(14, std::as_writable_bytes(std::span(back))), InputError);
}

TEST(Leftovers, AreRemovedUnlessTheyAreBeingWritten) {
  const TemporaryFolder folder;
  in_killed_process([&] {
    auto* leaked = new OutputFile(folder / "dead2.txt");
    leaked->write("x");
  });
  OutputFile alive(folder / "alive.txt");
  write_text_atomically(folder / ".mine", "a user's hidden file");
  remove_leftovers(folder.path());
  EXPECT_TRUE(fs::exists(folder / ".mine"));
  EXPECT_TRUE(fs::exists(OutputFile::temporary_name(folder / "alive.txt")));
  EXPECT_FALSE(fs::exists(OutputFile::temporary_name(folder / "dead2.txt")));
}

}  // namespace
}  // namespace groundloop
