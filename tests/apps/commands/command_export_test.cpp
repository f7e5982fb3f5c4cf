#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "backend/session/manifest.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/core/pcd.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

int run(const std::string& arguments, const std::filesystem::path& err) {
  const int status = std::system(
      (std::string(GROUNDLOOP_BINARY) + " export " + arguments + " >/dev/null 2>" + err.string())
          .c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// Two maps of three points a metre apart, the second 100 m up.
std::string write_session(const testing::TemporaryFolder& folder) {
  const SessionFolder session(folder / "session");
  std::filesystem::create_directories(session.file("local_maps"));
  const Points points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  std::vector<LocalMapRecord> maps(2);
  for (int i = 0; i < 2; ++i) {
    write_pcd(session.local_map(i), points);
    maps[i].map = i;
    maps[i].first_scan = maps[i].last_scan = static_cast<std::size_t>(i);
    maps[i].points = 3;
    maps[i].T_world_map.translation.z() = 100.0 * i;
  }
  write_local_maps(session.file("local_maps.csv"), maps);
  return session.path().string();
}

TEST(ExportCommand, WritesEachFormatFromTheOptimisedPoses) {
  const testing::TemporaryFolder folder;
  const std::string session = write_session(folder);
  for (const char* name : {"map.pcd", "map.ply", "map.las"}) {
    const auto out = folder / name;
    ASSERT_EQ(run(session + " --voxel 0 --out " + out.string(), folder / "err"), 0)
        << read_text(folder / "err");
    // Six records behind a header of known length: 384 bytes of text, 375 of LAS.
    const bool las = out.extension() == ".las";
    EXPECT_EQ(std::filesystem::file_size(out), las ? 375 + 6 * 20 : 384 + 6 * 12);
  }
}

TEST(ExportCommand, RefusesUncertaintyOfPoints) {
  const testing::TemporaryFolder folder;
  const std::string session = write_session(folder);
  EXPECT_EQ(run(session + " --uncertainty --out " + (folder / "map.pcd").string(), folder / "err"),
            2);
  EXPECT_NE(read_text(folder / "err").find(".csv"), std::string::npos);
}

TEST(ExportCommand, GivesThePointsOfAMergedSessionTheirRecording) {
  const testing::TemporaryFolder folder;
  const std::string session = write_session(folder);
  const auto manifest = [&](const char* frame_of_b) {
    Manifest written;
    written.stage = SessionStage::complete;
    written.scans = written.local_maps = 2;
    written.parts = {{"a", "", "", "", 1, 0, 1, 0, "a"}, {"b", "", "", "", 1, 1, 1, 1, frame_of_b}};
    write_manifest(SessionFolder(session), written);
  };
  const auto out = folder / "map.ply";
  manifest("a");
  ASSERT_EQ(run(session + " --voxel 0 --out " + out.string(), folder / "err"), 0)
      << read_text(folder / "err");
  std::string text = read_text(out);
  EXPECT_NE(text.find("session"), std::string::npos);
  EXPECT_NE(text.find("element vertex 6"), std::string::npos) << text.substr(0, 200);
  // The last two bytes of a record are the recording's place.
  const std::string records = text.substr(text.size() - 6 * 14);
  std::array<int, 2> points{};
  for (int i = 0; i < 6; ++i) ++points.at(static_cast<unsigned char>(records[14 * i + 12]));
  EXPECT_EQ(points, (std::array<int, 2>{3, 3}));

  manifest("b");  // in a frame of its own: not part of this map
  ASSERT_EQ(run(session + " --voxel 0 --out " + out.string(), folder / "err"), 0);
  text = read_text(out);
  EXPECT_NE(text.find("element vertex 3"), std::string::npos) << text.substr(0, 200);
  EXPECT_NE(read_text(folder / "err").find("'b' is not connected"), std::string::npos);
}

TEST(ExportCommand, FailsWithOneLineAndLeavesNothing) {
  const testing::TemporaryFolder folder;
  const std::string session = write_session(folder);
  const std::string out = (folder / "map.ply").string();
  EXPECT_EQ(run(session + ".absent --out " + out, folder / "err"), 2);
  EXPECT_EQ(run(session + " --out " + (folder / "map.xyz").string(), folder / "err"), 2);
  EXPECT_EQ(run(session + " --voxel -1 --out " + out, folder / "err"), 2);
  std::filesystem::remove(SessionFolder(session).local_map(1));
  EXPECT_EQ(run(session + " --out " + out, folder / "err"), 2);
  const std::string err = read_text(folder / "err");
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace groundloop
