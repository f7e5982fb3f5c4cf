// What a run may and may not do to the folder it is given. The old session, and whatever is none,
// stays.
#include "backend/session/session_output.hpp"

#include <csignal>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;
using State = SessionOutput::State;

SessionIdentity identity(const std::string& input = "recording") {
  return {"run", "1", input, "configuration"};
}

const SessionOutputOptions kPlain{};
const SessionOutputOptions kResume{false, true};
const SessionOutputOptions kOverwrite{true, false};
const SessionOutputOptions kOverwriteResume{true, true};

Manifest whole() {
  Manifest manifest;
  manifest.recording = {{"path", "r"}};
  manifest.sensor = "s";
  return manifest;
}

// Writes a session that says `what` in its trajectory.
void write_session(const fs::path& path, const std::string& what,
                   const SessionOutputOptions& options = kPlain,
                   const std::string& input = "recording") {
  SessionOutput output(path, identity(input), "a: 1\n", options);
  write_text_atomically(output.folder().file("trajectory.tum"), what);
  write_text_atomically(output.folder().local_map(0), what);
  output.complete(whole());
}

std::string trajectory(const fs::path& path) { return read_text(path / "trajectory.tum"); }

std::string refusal(const fs::path& path, const SessionOutputOptions& options,
                    const SessionIdentity& as = identity(),
                    const std::string& configuration = "a: 1\n") {
  try {
    const SessionOutput output(path, as, configuration, options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(SessionOutput, IsCompleteOnlyOnceItSaysSo) {
  const TemporaryFolder folder;
  {
    SessionOutput output(folder / "s", identity(), "a: 1\n", kPlain);
    EXPECT_EQ(output.state(), State::fresh);
    EXPECT_THROW((void)read_complete_manifest(output.folder()), InputError);
    EXPECT_EQ(read_text(output.folder().file("config.yaml")), "a: 1\n");
  }
  write_session(folder / "t", "done");
  EXPECT_EQ(read_complete_manifest(SessionFolder(folder / "t")).identity, identity());
}

TEST(SessionOutput, RefusesAFolderOfOtherFilesWhateverIsAsked) {
  const TemporaryFolder folder;
  for (const char* name : {"config.yaml", "map.pcd", "thesis.tex"})
    write_text_atomically(folder / "home" / name, "mine");
  write_text_atomically(folder / "home" / "local_maps" / "000000.pcd", "mine");
  for (const SessionOutputOptions& options : {kPlain, kResume, kOverwrite, kOverwriteResume}) {
    EXPECT_NE(refusal(folder / "home", options).find("no session"), std::string::npos);
    EXPECT_EQ(entries(folder / "home"), 4U);
    EXPECT_EQ(read_text(folder / "home" / "local_maps" / "000000.pcd"), "mine");
  }
}

TEST(SessionOutput, RefusesASessionUnlessAsked) {
  const TemporaryFolder folder;
  write_session(folder / "s", "old");
  EXPECT_NE(refusal(folder / "s", kPlain).find("--overwrite"), std::string::npos);
  EXPECT_EQ(trajectory(folder / "s"), "old");
  { const SessionOutput output(folder / "u", identity(), "a: 1\n", kPlain); }
  EXPECT_NE(refusal(folder / "u", kPlain).find("--resume"), std::string::npos);
}

TEST(SessionOutput, ResumingAFinishedSessionLeavesItAsItIs) {
  const TemporaryFolder folder;
  write_session(folder / "s", "old");
  const SessionOutput output(folder / "s", identity(), "a: 1\n", kResume);
  EXPECT_EQ(output.state(), State::finished);
  EXPECT_EQ(trajectory(folder / "s"), "old");
}

TEST(SessionOutput, ResumesOnlyWhatIsTheSame) {
  const TemporaryFolder folder;
  { const SessionOutput output(folder / "s", identity(), "a: 1\nb: 2  # why\n", kPlain); }
  EXPECT_EQ(SessionOutput(folder / "s", identity(), "a: 1\nb: 2\n", kResume).state(),
            State::resumed);
  EXPECT_NE(refusal(folder / "s", kResume, identity("other")).find("other input"),
            std::string::npos);
  const SessionIdentity other_configuration{"run", "1", "recording", "other"};
  const std::string text = refusal(folder / "s", kResume, other_configuration, "a: 1\nb: 3\n");
  EXPECT_NE(text.find("'b: 2' there, 'b: 3' now"), std::string::npos) << text;
  const SessionIdentity other_version{"run", "2", "recording", "configuration"};
  EXPECT_NE(refusal(folder / "s", kResume, other_version).find("groundloop 1, this is 2"),
            std::string::npos);
  const SessionIdentity merge{"merge", "1", "recording", "configuration"};
  EXPECT_NE(refusal(folder / "s", kResume, merge).find("groundloop run"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "s" / "config.yaml"));
}

TEST(SessionOutput, NothingToResumeIsSaidAndLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_NE(refusal(folder / "s", kResume).find("without --resume"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "s"));
}

TEST(SessionOutput, OverwritesOnceTheNewOneIsComplete) {
  const TemporaryFolder folder;
  write_session(folder / "s", "old");
  write_text_atomically(folder / "s" / "notes.txt", "a user's own");
  {
    SessionOutput output(folder / "s", identity("other"), "a: 1\n", kOverwrite);
    write_text_atomically(output.folder().file("trajectory.tum"), "new");
    EXPECT_EQ(trajectory(folder / "s"), "old");
    EXPECT_NO_THROW((void)read_complete_manifest(SessionFolder(folder / "s")));
    output.complete(whole());
    EXPECT_EQ(output.folder().path(), folder / "s");
  }
  EXPECT_EQ(trajectory(folder / "s"), "new");
  EXPECT_EQ(read_text(folder / "s" / "notes.txt"), "a user's own");
  EXPECT_FALSE(fs::exists(folder / "s" / "local_maps"));  // the old one's
  EXPECT_EQ(entries(folder.path()), 1U);
  EXPECT_FALSE(fs::exists(folder / "s" / ".groundloop-replacement"));
}

TEST(SessionOutput, AnOverwriteThatFailsLeavesTheOldSession) {
  const TemporaryFolder folder;
  write_session(folder / "s", "old");
  {
    SessionOutput output(folder / "s", identity("other"), "a: 1\n", kOverwrite);
    write_text_atomically(output.folder().file("trajectory.tum"), "half");
    output.discard();
  }
  EXPECT_EQ(trajectory(folder / "s"), "old");
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(SessionOutput, AnInterruptedOverwriteIsResumedOrBegunAnew) {
  const TemporaryFolder folder;
  write_session(folder / "s", "old");
  const auto begin = [&] {
    const SessionOutput output(folder / "s", identity("other"), "a: 1\n", kOverwrite);
    write_text_atomically(output.folder().file("odometry.tum"), "half");
  };
  begin();
  {
    SessionOutput output(folder / "s", identity("other"), "a: 1\n", kOverwriteResume);
    EXPECT_EQ(output.state(), State::resumed);
    EXPECT_EQ(read_text(output.folder().file("odometry.tum")), "half");
  }
  {
    const SessionOutput output(folder / "s", identity("third"), "a: 1\n", kOverwrite);
    EXPECT_EQ(output.state(), State::fresh);
    EXPECT_FALSE(fs::exists(output.folder().file("odometry.tum")));
  }
  EXPECT_EQ(trajectory(folder / "s"), "old");
}

TEST(SessionOutput, OneProcessAtATime) {
  const TemporaryFolder folder;
  const SessionOutput output(folder / "s", identity(), "a: 1\n", kPlain);
  for (const SessionOutputOptions& options : {kPlain, kResume, kOverwrite})
    EXPECT_NE(refusal(folder / "s", options).find("another groundloop"), std::string::npos);
}

TEST(SessionOutput, TheLockGoesWithItsProcess) {
  const TemporaryFolder folder;
  const pid_t pid = fork();
  if (pid == 0) {
    auto* leaked = new SessionOutput(folder / "s", identity(), "a: 1\n", kPlain);
    (void)leaked;
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(SessionOutput(folder / "s", identity(), "a: 1\n", kResume).state(), State::resumed);
}

TEST(SessionOutput, ALinkedFolderIsReplacedWhereItLies) {
  const TemporaryFolder folder;
  write_session(folder / "disk" / "s", "old");
  fs::create_symlink("disk/s", folder / "link");
  write_session(folder / "link", "new", kOverwrite);
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(trajectory(folder / "disk" / "s"), "new");
}

TEST(SessionOutput, ASessionThatCannotBeToldIsNotTouched) {
  const TemporaryFolder folder;
  write_session(folder / "s", "old");
  // Cut off, or of another program altogether.
  for (const char* text : {"{", "{\"name\": \"a web page\"}"}) {
    write_text_atomically(folder / "s" / "manifest.json", text);
    for (const SessionOutputOptions& options : {kPlain, kResume, kOverwrite, kOverwriteResume})
      EXPECT_NE(refusal(folder / "s", options).find("damaged"), std::string::npos);
    EXPECT_EQ(trajectory(folder / "s"), "old");
    EXPECT_EQ(entries(folder.path()), 1U);
  }
}

// Every state that a kill can leave between the steps of replacing.
TEST(SessionOutput, AReplacementThatWasCutOffIsBroughtToItsEnd) {
  const TemporaryFolder folder;
  const auto mark = [&](const fs::path& path) {
    write_text_atomically(path / ".groundloop-replacement", "");
  };
  // Complete, not yet in place.
  write_session(folder / "s", "old");
  write_session(folder / ".s.groundloop-new", "new", kPlain, "other");
  mark(folder / ".s.groundloop-new");
  EXPECT_EQ(SessionOutput(folder / "s", identity("other"), "a: 1\n", kOverwriteResume).state(),
            State::finished);
  EXPECT_EQ(trajectory(folder / "s"), "new");
  EXPECT_EQ(entries(folder.path()), 1U);
  // In place, the old one still beside it, with a file of the user's.
  write_session(folder / ".s.groundloop-new", "old");
  write_text_atomically(folder / ".s.groundloop-new" / "notes.txt", "mine");
  mark(folder / "s");
  EXPECT_EQ(SessionOutput(folder / "s", identity("other"), "a: 1\n", kResume).state(),
            State::finished);
  EXPECT_EQ(trajectory(folder / "s"), "new");
  EXPECT_EQ(read_text(folder / "s" / "notes.txt"), "mine");
  EXPECT_EQ(entries(folder.path()), 1U);
  // Where the file system cannot exchange: the old one moved away, nothing in its place.
  fs::rename(folder / "s", folder / ".s.groundloop-old");
  EXPECT_NE(refusal(folder / "s", kPlain).find("--overwrite"), std::string::npos);
  EXPECT_EQ(trajectory(folder / "s"), "new");
}

TEST(SessionOutput, DiscardsWhatItMadeAndNothingElse) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "empty");
  {
    SessionOutput output(folder / "empty", identity(), "a: 1\n", kPlain);
    output.discard();
  }
  EXPECT_TRUE(fs::is_empty(folder / "empty"));
  {
    SessionOutput output(folder / "made", identity(), "a: 1\n", kPlain);
    output.discard();
  }
  EXPECT_FALSE(fs::exists(folder / "made"));
}

}  // namespace
}  // namespace groundloop
