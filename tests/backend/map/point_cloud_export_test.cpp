#include "backend/map/point_cloud_export.hpp"

#include <cstring>
#include <map>
#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "backend/map/map_assembly.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/core/pcd.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::TemporaryFolder;

template <typename T>
T at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::vector<ExportPoint> some_points(std::size_t n) {
  std::mt19937 generator(1);
  const auto coordinate = [&] { return static_cast<double>(generator() % 2000001) / 1000.0 - 1e3; };
  std::vector<ExportPoint> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = coordinate();
    const double y = coordinate();
    points.push_back({{x, y, coordinate()}, static_cast<std::uint16_t>(i % 3)});
  }
  return points;
}

void write_in_chunks(const std::filesystem::path& file, bool with_session,
                     const std::vector<ExportPoint>& points) {
  const auto writer = open_point_cloud_writer(file, {with_session, false, 0.0F});
  const std::span<const ExportPoint> all(points);
  writer->write(all.first(points.size() / 3));
  writer->write(all.subspan(points.size() / 3));
  EXPECT_FALSE(std::filesystem::exists(file)) << "before finish()";
  writer->finish();
  EXPECT_EQ(writer->count(), points.size());
}

TEST(PointCloudExport, PlyFollowsItsHeader) {
  const TemporaryFolder folder;
  const auto points = some_points(1000);
  for (const bool with_session : {false, true}) {
    const auto file = folder / (with_session ? "with.ply" : "without.ply");
    write_in_chunks(file, with_session, points);
    const std::string bytes = read_text(file);
    std::istringstream header(bytes);
    std::string line;
    std::size_t count = 0;
    std::string properties;
    std::getline(header, line);
    EXPECT_EQ(line, "ply");
    std::getline(header, line);
    EXPECT_EQ(line, "format binary_little_endian 1.0");
    while (std::getline(header, line) && line != "end_header") {
      if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
      if (line.starts_with("property ")) properties += line.substr(9) + ";";
    }
    const auto body = static_cast<std::size_t>(header.tellg());
    const std::size_t record = with_session ? 14 : 12;
    EXPECT_EQ(properties, with_session ? "float x;float y;float z;ushort session;"
                                       : "float x;float y;float z;");
    ASSERT_EQ(count, points.size());
    ASSERT_EQ(bytes.size(), body + count * record);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NEAR(at<float>(bytes, body + i * record + 4), points[i].position.y(), 1e-4);
      if (with_session) {
        EXPECT_EQ(at<std::uint16_t>(bytes, body + i * record + 12), i % 3);
      }
    }
  }
}

TEST(PointCloudExport, PcdFollowsItsHeader) {
  const TemporaryFolder folder;
  const auto points = some_points(12345);
  write_in_chunks(folder / "a.pcd", true, points);
  const std::string bytes = read_text(folder / "a.pcd");
  std::istringstream header(bytes);
  std::map<std::string, std::string> entries;
  std::string line;
  while (std::getline(header, line)) {
    if (line.starts_with("#")) continue;
    const std::size_t space = line.find(' ');
    entries[line.substr(0, space)] = line.substr(space + 1);
    if (line.starts_with("DATA")) break;
  }
  const auto body = static_cast<std::size_t>(header.tellg());
  EXPECT_EQ(entries["FIELDS"], "x y z session");
  EXPECT_EQ(entries["SIZE"], "4 4 4 2");
  EXPECT_EQ(entries["TYPE"], "F F F U");
  EXPECT_EQ(entries["WIDTH"], "12345");
  EXPECT_EQ(entries["POINTS"], "12345");
  EXPECT_EQ(entries["DATA"], "binary");
  ASSERT_EQ(bytes.size(), body + points.size() * 14);
  EXPECT_NEAR(at<float>(bytes, body + 14 * 12344 + 8), points.back().position.z(), 1e-4);
}

// Offsets as in the ASPRS LAS 1.2 specification, Sec. 2.2.
TEST(PointCloudExport, LasFollowsItsSpecification) {
  const TemporaryFolder folder;
  const auto points = some_points(1000);
  write_in_chunks(folder / "a.LAS", true, points);
  const std::string bytes = read_text(folder / "a.LAS");
  EXPECT_EQ(bytes.substr(0, 4), "LASF");
  EXPECT_EQ(at<std::uint8_t>(bytes, 24), 1);
  EXPECT_EQ(at<std::uint8_t>(bytes, 25), 2);
  EXPECT_EQ(at<std::uint16_t>(bytes, 94), 227);
  const auto body = at<std::uint32_t>(bytes, 96);
  EXPECT_GE(body, 227U);
  EXPECT_EQ(at<std::uint32_t>(bytes, 100), 0U);
  EXPECT_EQ(at<std::uint8_t>(bytes, 104), 0);
  ASSERT_EQ(at<std::uint16_t>(bytes, 105), 20);
  ASSERT_EQ(at<std::uint32_t>(bytes, 107), points.size());
  EXPECT_EQ(at<std::uint32_t>(bytes, 111), points.size());
  ASSERT_EQ(bytes.size(), body + points.size() * 20);
  Eigen::Vector3d min = points[0].position;
  Eigen::Vector3d max = points[0].position;
  for (std::size_t i = 0; i < points.size(); ++i) {
    min = min.cwiseMin(points[i].position);
    max = max.cwiseMax(points[i].position);
    const std::size_t record = body + i * 20;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value =
          at<std::int32_t>(bytes, record + 4 * k) * at<double>(bytes, 131 + 8 * k) +
          at<double>(bytes, 155 + 8 * k);
      EXPECT_NEAR(value, points[i].position[static_cast<int>(k)], 0.0005001);
    }
    EXPECT_EQ(at<std::uint16_t>(bytes, record + 18), i % 3);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(at<double>(bytes, 179 + 16 * k), max[static_cast<int>(k)], 1e-9);
    EXPECT_NEAR(at<double>(bytes, 187 + 16 * k), min[static_cast<int>(k)], 1e-9);
  }
}

// The records of a file of one point.
std::string record_of(const std::filesystem::path& file, const ExportFields& fields,
                      float intensity, std::size_t header) {
  const auto writer = open_point_cloud_writer(file, fields);
  const std::vector<ExportPoint> point{{{1, 2, 3}, 7, intensity}};
  writer->write(point);
  writer->finish();
  return read_text(file).substr(header);
}

TEST(PointCloudExport, HasIntensitiesWhereTheyAreKnown) {
  const TemporaryFolder folder;
  const ExportFields fields{true, true, 200.0F};
  for (const char* name : {"a.pcd", "a.ply"}) {
    const std::string record = record_of(folder / name, fields, 123.5F, 384);
    ASSERT_EQ(record.size(), 4 * sizeof(float) + 2);
    float intensity = 0.0F;
    std::memcpy(&intensity, record.data() + 12, sizeof intensity);
    EXPECT_EQ(intensity, 123.5F);
    EXPECT_EQ(record[16], 7);
  }
  EXPECT_NE(read_text(folder / "a.pcd")
                .find("FIELDS x y z intensity session\nSIZE 4 4 4 4 2\nTYPE "
                      "F F F F U\nCOUNT 1 1 1 1 1\n"),
            std::string::npos);
  EXPECT_NE(read_text(folder / "a.ply").find("property float intensity\nproperty ushort session"),
            std::string::npos);
  // LAS 1.4 R15, table 7: normalised to 16 bits; bytes 12 and 13 of a record.
  const auto in_las = [&](float largest, float intensity) {
    const std::string record = record_of(folder / "a.las", {false, true, largest}, intensity, 375);
    std::uint16_t value = 0;
    std::memcpy(&value, record.data() + 12, sizeof value);
    return value;
  };
  EXPECT_EQ(in_las(1.0F, 1.0F), 65535);
  EXPECT_EQ(in_las(255.0F, 255.0F), 65535);
  EXPECT_EQ(in_las(255.0F, 2.0F), 514);
  EXPECT_EQ(in_las(3000.0F, 2999.0F), 2999);
}

TEST(PointCloudExport, LeavesNothingBehindWithoutFinish) {
  const TemporaryFolder folder;
  for (const char* name : {"a.pcd", "a.ply", "a.las"}) {
    open_point_cloud_writer(folder / name, {})->write(some_points(10));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(PointCloudExport, RefusesWhatItCannotWrite) {
  const TemporaryFolder folder;
  EXPECT_THROW((void)open_point_cloud_writer(folder / "a.xyz", {}), InputError);
  write_text_atomically(folder / "file", "");
  EXPECT_THROW((void)open_point_cloud_writer(folder / "file/a.las", {}), InputError);
  const auto writer = open_point_cloud_writer(folder / "a.las", {});
  const std::vector<ExportPoint> far{{{0, 0, 3e6}, 0, 0.0F}};
  EXPECT_THROW(writer->write(far), InputError);
}

// Collects what an assembly writes.
class Collector : public PointCloudWriter {
 public:
  void write(std::span<const ExportPoint> points) override {
    all.insert(all.end(), points.begin(), points.end());
    largest = std::max(largest, points.size());
    count_ = all.size();
  }
  void finish() override {}
  std::vector<ExportPoint> all;
  std::size_t largest = 0;
};

TEST(MapAssembly, PutsMapsAtTheirPosesAndMergesVoxels) {
  const TemporaryFolder folder;
  // A line of points along x; the second map shows its last half again, from its own frame.
  Points first;
  for (int i = 0; i < 200; ++i) first.emplace_back(0.5F + static_cast<float>(i), 0.5F, 0.5F);
  Pose T_world_second;
  T_world_second.translation = {100.0, 0.0, 0.2};
  Points second;
  for (int i = 0; i < 200; ++i) second.emplace_back(0.5F + static_cast<float>(i), 0.5F, 0.5F);
  write_pcd(folder / "0.pcd", first);
  write_pcd(folder / "1.pcd", second);
  const std::vector<MapPiece> pieces{rigid_piece(folder / "0.pcd", Pose()),
                                     rigid_piece(folder / "1.pcd", T_world_second, 1)};
  MapAssemblyOptions options;
  options.voxel_size = 1.0;
  Collector map;
  EXPECT_EQ(assemble_map(pieces, options, map, folder.path()), 300U);
  std::map<double, ExportPoint> by_x;
  for (const ExportPoint& point : map.all) by_x[point.position.x()] = point;
  ASSERT_EQ(by_x.size(), 300U);
  EXPECT_NEAR(by_x[50.5].position.z(), 0.5, 1e-5);
  EXPECT_NEAR(by_x[150.5].position.z(), 0.6, 1e-5);  // mean of both
  EXPECT_NEAR(by_x[250.5].position.z(), 0.7, 1e-5);
  EXPECT_EQ(by_x[150.5].session, 0);
  EXPECT_EQ(by_x[250.5].session, 1);
  EXPECT_LE(map.largest, 50U) << "a tile at a time";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2)
      << "the temporary file is gone";
}

TEST(MapAssembly, FollowsTheTrajectoryInsideAMap) {
  const TemporaryFolder folder;
  // Odometry went straight for 100 m; the solution climbs an arc of 500 m radius. A point lay at
  // each scan, and 3 m to its left.
  Trajectory odometry;
  Trajectory trajectory;
  Points points;
  const auto on_arc = [](double s) {
    return Pose(exp_so3({0.0, -s / 500, 0.0}),
                {500 * std::sin(s / 500), 7.0, 500 * (1 - std::cos(s / 500))});
  };
  for (int i = 0; i <= 200; ++i) {
    const double s = 0.5 * i;
    odometry.push_back({i, Pose(Eigen::Quaterniond::Identity(), {s + 20, -4.0, 0.0})});
    trajectory.push_back({i, on_arc(s)});
    points.emplace_back(static_cast<float>(s), 0.0F, 0.0F);
    points.emplace_back(static_cast<float>(s), 3.0F, 0.0F);
  }
  write_pcd(folder / "0.pcd", points);
  MapAssemblyOptions options;
  options.voxel_size = 0.0;
  Collector map;
  const LocalMapRecord record{0, 0, 200, points.size(), trajectory.front().pose};
  EXPECT_EQ(assemble_map({bent_piece(folder / "0.pcd", record, odometry, trajectory)}, options, map,
                         folder.path()),
            402U);
  for (std::size_t i = 0; i < map.all.size(); ++i) {
    const Eigen::Vector3d expected =
        on_arc(0.25 * static_cast<double>(i - i % 2)) * Eigen::Vector3d(0, i % 2 == 0 ? 0 : 3, 0);
    // A scan within 2 m, whose tangent leaves the arc by 2^2 / (2 * 500) m.
    EXPECT_LT((map.all[i].position - expected).norm(), 0.004) << i;
  }
}

TEST(MapAssembly, KeepsEveryPointWithoutVoxels) {
  const TemporaryFolder folder;
  const Points points(10, Eigen::Vector3f(1, 2, 3));
  write_pcd(folder / "0.pcd", points);
  MapAssemblyOptions options;
  options.voxel_size = 0.0;
  Collector map;
  EXPECT_EQ(assemble_map({rigid_piece(folder / "0.pcd", Pose())}, options, map, folder.path()),
            10U);
}

TEST(MapAssembly, NeverSplitsAVoxelAtATileBorder) {
  const TemporaryFolder folder;
  // Two points in each voxel of 0.3 m along a way of many tiles.
  Points points;
  for (int i = 0; i < 3000; ++i) {
    points.emplace_back(0.3F * static_cast<float>(i) + 0.05F, 0.1F, 0.1F);
    points.emplace_back(0.3F * static_cast<float>(i) + 0.25F, 0.1F, 0.1F);
  }
  write_pcd(folder / "0.pcd", points);
  MapAssemblyOptions options;
  options.voxel_size = 0.3;
  options.tile_size = 10.0;
  Collector map;
  EXPECT_EQ(assemble_map({rigid_piece(folder / "0.pcd", Pose())}, options, map, folder.path()),
            3000U);
}

}  // namespace
}  // namespace groundloop
