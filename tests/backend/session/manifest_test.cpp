#include "backend/session/manifest.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using Json = nlohmann::ordered_json;
using testing::TemporaryFolder;

Manifest merged_manifest() {
  Manifest manifest;
  manifest.stage = SessionStage::complete;
  manifest.identity = {"merge", "1.2.3", "in", "conf"};
  manifest.scans = 5;
  manifest.local_maps = 3;
  manifest.parts = {{"a", "x/a", "rec_a", "64 beams", 2, 0, 1, 0, "a", true, true},
                    {"b", "x/b", "rec_b", "", 3, 2, 2, 1, "a", true, false}};
  manifest.left_out = {{"x/c", "damaged"}};
  manifest.connections = {"'b' is joined to 'a'"};
  manifest.checksums = {{"closures.csv", "00"}};
  return manifest;
}

TEST(Manifest, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  write_manifest(session, merged_manifest());
  const Manifest read = read_complete_manifest(session);
  EXPECT_EQ(read.identity, merged_manifest().identity);
  EXPECT_EQ(read.scans, 5U);
  ASSERT_EQ(read.parts.size(), 2U);
  EXPECT_EQ(read.parts[1].name, "b");
  EXPECT_EQ(read.parts[1].input, "x/b");
  EXPECT_EQ(read.parts[1].recording, "rec_b");
  EXPECT_EQ(read.parts[0].sensor, "64 beams");
  EXPECT_EQ(read.parts[1].first_scan, 2U);
  EXPECT_EQ(read.parts[1].scans, 3U);
  EXPECT_EQ(read.parts[1].first_map, 1U);
  EXPECT_EQ(read.parts[1].local_maps, 2U);
  EXPECT_EQ(read.parts[1].frame, "a");
  EXPECT_TRUE(read.parts[0].fixed);
  EXPECT_EQ(read.left_out.front().reason, "damaged");
  EXPECT_EQ(read.connections, merged_manifest().connections);
  EXPECT_EQ(read.checksums, merged_manifest().checksums);
}

// A manifest that somebody else's program, or a mistake, made.
struct Fault {
  const char* name;
  std::function<void(Json&)> make;
  const char* expected;
};

class ManifestWithFault : public ::testing::TestWithParam<Fault> {};

TEST_P(ManifestWithFault, IsRefusedWithItsPlace) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  write_manifest(session, merged_manifest());
  Json document = Json::parse(read_text(session.file("manifest.json")));
  GetParam().make(document);
  write_text_atomically(session.file("manifest.json"), document.dump());
  try {
    (void)read_complete_manifest(session);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("manifest.json"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find(GetParam().expected), std::string::npos) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Faults, ManifestWithFault,
    ::testing::Values(
        Fault{"PathAsName", [](Json& j) { j["sessions"][0]["name"] = "../../escaped"; },
              "no plain name"},
        Fault{"AbsoluteName", [](Json& j) { j["sessions"][0]["name"] = "/etc"; }, "no plain name"},
        Fault{"DotDot", [](Json& j) { j["sessions"][1]["name"] = ".."; }, "no plain name"},
        Fault{"EmptyName", [](Json& j) { j["sessions"][1]["name"] = ""; }, "no plain name"},
        Fault{"LineBreakInName", [](Json& j) { j["sessions"][1]["name"] = "a\nb"; },
              "no plain name"},
        Fault{"NameIsNoText", [](Json& j) { j["sessions"][1]["name"] = 3; }, "damaged"},
        Fault{"TwoOfOneName", [](Json& j) { j["sessions"][1]["name"] = "a"; }, "two sessions"},
        Fault{"UnknownFrame", [](Json& j) { j["sessions"][1]["frame"] = "z"; }, "frame"},
        Fault{"NegativeCount", [](Json& j) { j["sessions"][1]["scans"] = -3; }, "no count"},
        Fault{"HugeCount", [](Json& j) { j["local_maps"] = 1e18; }, "no count"},
        Fault{"HugeWholeCount", [](Json& j) { j["local_maps"] = 1'000'000'000'000'000'000LL; },
              "no count"},
        Fault{"Gap", [](Json& j) { j["sessions"][1]["first_map"] = 2; }, "does not follow"},
        Fault{"OtherSum", [](Json& j) { j["scans"] = 6; }, "add up"},
        Fault{"NoIdentity", [](Json& j) { j.erase("made_by"); }, "damaged"},
        Fault{"NoChecksums", [](Json& j) { j.erase("checksums"); }, "damaged"},
        Fault{"UnknownStage", [](Json& j) { j["stage"] = "done"; }, "stage 'done'"},
        Fault{"Unfinished", [](Json& j) { j["stage"] = "odometry"; }, "merge --resume"},
        Fault{"OlderFormat", [](Json& j) { j["session_format"] = 1; }, "groundloop merge"},
        Fault{"NoFormat", [](Json& j) { j.erase("session_format"); }, "format 0"},
        Fault{"NoObject", [](Json& j) { j = Json::array(); }, "no JSON object"}),
    [](const auto& fault) { return std::string(fault.param.name); });

TEST(Manifest, OneThatIsCutOffIsRefused) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  write_manifest(session, merged_manifest());
  const std::string text = read_text(session.file("manifest.json"));
  for (std::size_t length = 0; length < text.size() - 1; length += 7) {
    write_text_atomically(session.file("manifest.json"), text.substr(0, length));
    EXPECT_THROW((void)read_manifest(session), InputError) << length;
  }
}

}  // namespace
}  // namespace groundloop
