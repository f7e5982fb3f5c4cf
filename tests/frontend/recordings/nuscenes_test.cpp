// nuScenes' folder, written after the data set's schema: tables in JSON, scans of five float32.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;

class Nuscenes : public ::testing::Test {
 protected:
  Nuscenes() {
    const auto table = [&](const std::string& name, const std::string& rows) {
      write_file(folder_ / ("v1.0-mini/" + name + ".json"), "[\n" + rows + "\n]\n");
    };
    table("scene", R"({"token": "s1", "name": "scene-0061", "first_sample_token": "a"},
                      {"token": "s2", "name": "scene-0103", "first_sample_token": "c"})");
    table("sample", R"({"token": "a", "scene_token": "s1", "timestamp": 1532402927647951},
                       {"token": "b", "scene_token": "s1", "timestamp": 1532402928147847},
                       {"token": "c", "scene_token": "s2", "timestamp": 1532402929000000})");
    // Two key frames of the first scene, in the wrong order, with a sweep between them; a sweep
    // that is not there; a picture; a scan of the other scene.
    table("sample_data",
          data("b", "e3", "samples/LIDAR_TOP/n__LIDAR_TOP__3.pcd.bin", 1532402928147847) + ",\n" +
              data("a", "e1", "samples/LIDAR_TOP/n__LIDAR_TOP__1.pcd.bin", 1532402927647951) +
              ",\n" +
              data("b", "e2", "sweeps/LIDAR_TOP/n__LIDAR_TOP__2.pcd.bin", 1532402927697743) +
              ",\n" + data("b", "e2", "sweeps/LIDAR_TOP/gone.pcd.bin", 1532402927747000) + ",\n" +
              data("a", "e1", "samples/CAM_FRONT/n__CAM_FRONT__1.jpg", 1532402927612460) + ",\n" +
              data("c", "e4", "samples/LIDAR_TOP/other.pcd.bin", 1532402929000000));
    // The car 10 m along x a scan, turned to the left by a right angle at the last.
    table("ego_pose", ego("e1", 400, "1, 0, 0, 0") + "," + ego("e2", 410, "1, 0, 0, 0") + "," +
                          ego("e3", 420, "0.70710678118654752, 0, 0, 0.70710678118654752") + "," +
                          ego("e4", 0, "1, 0, 0, 0"));
    table("calibrated_sensor",
          R"({"token": "cs", "sensor_token": "x", "translation": [0.9, 0.0, 1.8],
              "rotation": [0.70710678118654752, 0, 0, -0.70710678118654752],
              "camera_intrinsic": []})");
    const std::vector<std::string> files = {
        "samples/LIDAR_TOP/n__LIDAR_TOP__1.pcd.bin", "sweeps/LIDAR_TOP/n__LIDAR_TOP__2.pcd.bin",
        "samples/LIDAR_TOP/n__LIDAR_TOP__3.pcd.bin", "samples/LIDAR_TOP/other.pcd.bin"};
    for (std::size_t i = 0; i < files.size(); ++i)
      write_file(folder_ / files[i], Bytes().floats(1 + i, 2, 3, 40, 7, -1, 0, 5, 20, 31));
  }
  static std::string data(const std::string& sample, const std::string& ego,
                          const std::string& file, std::int64_t stamp) {
    return R"({"token": "d", "sample_token": ")" + sample + R"(", "ego_pose_token": ")" + ego +
           R"(", "calibrated_sensor_token": "cs", "timestamp": )" + std::to_string(stamp) +
           R"(, "fileformat": "pcd", "is_key_frame": true, "filename": ")" + file + R"("})";
  }
  static std::string ego(const std::string& token, int x, const std::string& rotation) {
    return R"({"token": ")" + token + R"(", "timestamp": 1, "rotation": [)" + rotation +
           R"(], "translation": [)" + std::to_string(x) + R"(.0, 1000.0, 0.0]})";
  }
  std::unique_ptr<Recording> open(const std::string& scene, const std::string& below = "") {
    RecordingOptions options;
    options.topic = scene;
    options.attributes = AttributeSet::all();
    return open_recording((folder_ / below).string(), options);
  }
  std::string error_of(const std::string& scene) {
    try {
      (void)open(scene);
    } catch (const InputError& e) {
      EXPECT_THAT(std::string(e.what()), ::testing::Not(HasSubstr("\n")));
      return e.what();
    }
    return "none";
  }
  TemporaryFolder folder_;
};

TEST_F(Nuscenes, SceneIsReadInTheOrderOfTime) {
  for (const char* below : {"", "v1.0-mini"}) {
    const auto recording = open("scene-0061", below);
    EXPECT_EQ(recording->info().format, "nuscenes");
    ASSERT_EQ(recording->size(), 3U);
    EXPECT_EQ(recording->stamp(0), 1'532'402'927'647'951'000);
    EXPECT_EQ(recording->stamp(1), 1'532'402'927'697'743'000);
    const Scan scan = recording->read(1);
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points[0], Eigen::Vector3f(2, 2, 3));
    EXPECT_EQ(scan.attributes.ring[1], 31);
    EXPECT_EQ(scan.attributes.intensity[0], 40.0F);
    EXPECT_THAT(recording->info().warnings, Contains(HasSubstr("1 scans of the scene are listed")));
  }
}

TEST_F(Nuscenes, EgoPosesAreBroughtToTheLidar) {
  const Trajectory truth = open("scene-0061")->ground_truth();
  ASSERT_EQ(truth.size(), 3U);
  EXPECT_LT((truth[0].pose.translation - Eigen::Vector3d(400.9, 1000, 1.8)).norm(), 1e-9);
  // The LiDAR's y points to the front of the car.
  EXPECT_LT((truth[0].pose.rotation * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitX()).norm(),
            1e-9);
  EXPECT_LT((truth[2].pose.translation - Eigen::Vector3d(420, 1000.9, 1.8)).norm(), 1e-9);
  EXPECT_LT((truth[2].pose.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitX()).norm(),
            1e-9);
}

TEST_F(Nuscenes, ScenesAreListedWhereNoneIsChosen) {
  EXPECT_THAT(error_of(""), HasSubstr("choose one with --topic: scene-0061, scene-0103"));
  EXPECT_THAT(error_of("scene-1"), HasSubstr("has no scene scene-1; choose one of scene-0061"));
  EXPECT_EQ(open("scene-0103")->size(), 1U);
}

TEST_F(Nuscenes, WhatIsWrongWithTablesIsNamed) {
  const auto expect = [&](const std::string& table, const std::string& content,
                          const std::string& part) {
    const auto file = folder_ / ("v1.0-mini/" + table + ".json");
    std::ifstream in(file);
    const std::string before((std::istreambuf_iterator<char>(in)), {});
    write_file(file, content);
    EXPECT_THAT(error_of("scene-0061"), HasSubstr(table + ".json: " + part)) << content;
    write_file(file, before);
  };
  expect("ego_pose", "[{\"token\": \"e1\"", "cannot be read as one of nuScenes' tables");
  expect("ego_pose", "[]", "lacks 3 rows");
  expect("ego_pose", "[" + ego("e1", 0, "2, 0, 0, 0") + "]", "'rotation' has norm 2");
  expect("calibrated_sensor", "[{\"token\": \"cs\"}]", "cannot be read");
  expect("sample_data", "[" + data("a", "e1", "../LIDAR_TOP/x.bin", 1) + "]",
         "file name '../LIDAR_TOP/x.bin' lies outside");
}

}  // namespace
}  // namespace groundloop
