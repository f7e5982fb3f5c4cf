#include "loopclosure/loop_database.hpp"

#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "loopclosure/describe.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

// A town block without two alike corners: walls of random place, length and direction on a ground.
Points town(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  Points points;
  for (int i = 0; i < 60000; ++i) {
    points.emplace_back(-80 + 160 * unit(rng), -80 + 160 * unit(rng), -1.7F + 0.02F * unit(rng));
  }
  for (int wall = 0; wall < 60; ++wall) {
    const Eigen::Vector2f from(-70 + 140 * unit(rng), -70 + 140 * unit(rng));
    const float angle = 6.28F * unit(rng), length = 4 + 16 * unit(rng), height = 2 + 8 * unit(rng);
    for (int i = 0; i < static_cast<int>(length * height * 20); ++i) {
      const Eigen::Vector2f p =
          from + Eigen::Vector2f(std::cos(angle), std::sin(angle)) * length * unit(rng);
      points.emplace_back(p.x(), p.y(), -1.7F + height * unit(rng));
    }
  }
  return points;
}

Points moved(const Points& points, const Pose& T) {
  const PoseF transform(T);
  Points result;
  for (const Eigen::Vector3f& p : points) result.push_back(transform * p);
  return result;
}

TEST(LoopDatabase, KeepsTheNearestMatchOfAFeatureInEachMapWhereAskedTo) {
  LoopClosureOptions options;
  options.matching.method = "exhaustive";
  MapDescription a, b, query;
  a.key = {0, 0}, b.key = {0, 1}, query.key = {0, 9};
  const auto add = [](MapDescription& d, int ones) {
    d.keypoints.emplace_back(0.0F, 0.0F);
    d.orientations.push_back(0.0F);
    d.descriptors.push_back({(1ULL << ones) - 1, 0, 0, 0});
  };
  add(query, 0);
  for (const int ones : {9, 4, 6}) add(a, ones);
  for (const int ones : {12, 20}) add(b, ones);
  for (const bool nearest : {false, true}) {
    options.matching.nearest_only = nearest;
    LoopDatabase database(options);
    database.insert(a);
    database.insert(b);
    const auto matches = database.match(query);
    ASSERT_EQ(matches.size(), 2U);
    EXPECT_EQ(matches[0].size(), nearest ? 1U : 3U);
    EXPECT_EQ(matches[1].size(), nearest ? 1U : 2U);
    if (nearest) {
      EXPECT_EQ(matches[0][0].distance, 4);
      EXPECT_EQ(matches[1][0].distance, 12);
    }
  }
}

TEST(LoopDatabase, FindsAnotherViewOfAPlaceWithItsPoseInThreeDimensions) {
  const LoopClosureOptions options;
  LoopDatabase database(options);
  for (int map = 0; map < 4; ++map) {
    database.insert(describe_map({0, map}, town(static_cast<std::uint64_t>(map)), options));
  }
  // Place 2 again, turned, shifted and tilted by 20 degrees.
  const Pose T_query_reference = Pose(exp_so3({0.25, -0.25, 0}), Eigen::Vector3d(0, 0, 0.4)) *
                                 Pose(exp_so3({0, 0, 2.2}), Eigen::Vector3d(12, -7, 0));
  const MapDescription query = describe_map({0, 9}, moved(town(2), T_query_reference), options);
  const std::vector<ClosureCandidate> candidates = database.query(query);
  ASSERT_FALSE(candidates.empty());
  for (const ClosureCandidate& c : candidates) {
    EXPECT_EQ(c.query, (MapKey{0, 9}));
    EXPECT_GE(c.inliers, 3);
  }
  const ClosureCandidate best =
      *std::max_element(candidates.begin(), candidates.end(),
                        [](const auto& a, const auto& b) { return a.inliers < b.inliers; });
  EXPECT_EQ(best.reference.map, 2);
  EXPECT_GT(best.inliers, 5);
  const Vector6d error = log_se3(T_query_reference.inverse() * best.T_query_reference);
  EXPECT_LT(error.head<3>().norm(), 1.0);
  EXPECT_LT(error.tail<3>().norm(), 1.0 * M_PI / 180);
}

MapDescription handmade(MapKey key, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  MapDescription d;
  d.key = key;
  d.ground_quality = 0.75;
  d.T_ground_map = Pose(exp_so3({0.1, 0.2, 0.3}), {1, 2, 3});
  for (int i = 0; i < 30; ++i) {
    d.keypoints.emplace_back(static_cast<float>(rng() % 100), static_cast<float>(rng() % 100));
    d.orientations.push_back(static_cast<float>(rng() % 6));
    d.descriptors.push_back({rng(), rng(), rng(), rng()});
  }
  return d;
}

MapDescription renamed(MapDescription d, MapKey key) {
  d.key = key;
  return d;
}

TEST(LoopDatabase, SkipsThreeMapsBeforeTheQueryInItsOwnSessionOnly) {
  LoopDatabase database({});
  const MapDescription place = handmade({0, 0}, 1);
  for (int map = 0; map < 8; ++map) {
    database.insert(renamed(place, {0, map}));
    database.insert(renamed(place, {1, map}));
  }
  std::vector<MapKey> references;
  for (const auto& c : database.query(renamed(place, {1, 6}))) references.push_back(c.reference);
  const std::vector<MapKey> expected{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5},
                                     {0, 6}, {0, 7}, {1, 0}, {1, 1}, {1, 2}};
  EXPECT_EQ(references, expected);
}

TEST(LoopDatabase, RemovingASessionLeavesTheOthersAsIfItHadNeverBeen) {
  LoopDatabase both({}), one({});
  for (int map = 0; map < 5; ++map) {
    both.insert(handmade({0, map}, static_cast<std::uint64_t>(map)));
    both.insert(handmade({1, map}, static_cast<std::uint64_t>(10 + map)));
    one.insert(handmade({1, map}, static_cast<std::uint64_t>(10 + map)));
  }
  both.remove_session(0);
  ASSERT_EQ(both.descriptions().size(), 5U);
  const MapDescription query = handmade({2, 0}, 12);
  const auto a = both.query(query), b = one.query(query);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].reference, b[i].reference);
    EXPECT_EQ(a[i].inliers, b[i].inliers);
  }
}

TEST(LoopDatabase, ReadsBackWhatItWroteBitForBit) {
  const testing::TemporaryFolder folder;
  LoopDatabase database({});
  for (int map = 0; map < 12; ++map) {
    database.insert(handmade({map / 8, map}, static_cast<std::uint64_t>(map)));
  }
  database.insert(renamed({}, {7, 0}));  // a map without features is kept too
  database.save(folder / "a.bin");
  const LoopDatabase loaded = LoopDatabase::load(folder / "a.bin", {});
  loaded.save(folder / "b.bin");
  EXPECT_EQ(read_text(folder / "a.bin"), read_text(folder / "b.bin"));
  ASSERT_EQ(loaded.descriptions().size(), 13U);
  EXPECT_EQ(loaded.descriptions()[3].descriptors, database.descriptions()[3].descriptors);
  EXPECT_EQ(loaded.descriptions()[3].keypoints, database.descriptions()[3].keypoints);
  EXPECT_EQ(loaded.descriptions()[3].T_ground_map.matrix(),
            database.descriptions()[3].T_ground_map.matrix());
  const MapDescription query = handmade({5, 0}, 3);
  EXPECT_EQ(loaded.query(query).size(), database.query(query).size());
}

void expect_refused(const std::filesystem::path& file, const std::string& reason) {
  try {
    (void)LoopDatabase::load(file, {});
    ADD_FAILURE() << file << " was accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(file.filename().string()), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
  }
}

TEST(LoopDatabase, RefusesOtherAndDamagedFiles) {
  const testing::TemporaryFolder folder;
  LoopDatabase database({});
  database.insert(handmade({0, 0}, 1));
  database.save(folder / "good.bin");
  const std::string good = read_text(folder / "good.bin");

  write_text_atomically(folder / "short.bin", good.substr(0, 10));
  expect_refused(folder / "short.bin", "no loop database");
  write_text_atomically(folder / "other.bin", std::string(200, 'x'));
  expect_refused(folder / "other.bin", "no loop database");
  std::string damaged = good;
  damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 1);
  write_text_atomically(folder / "damaged.bin", damaged);
  expect_refused(folder / "damaged.bin", "checksum");
  std::string newer = good;
  newer[8] = 99;
  write_text_atomically(folder / "newer.bin", newer);
  expect_refused(folder / "newer.bin", "version 99");
  expect_refused(folder / "absent.bin", "");
}

TEST(LoopDatabase, QueriesWithoutFeaturesOrDatabaseHaveNoCandidates) {
  LoopDatabase database({});
  EXPECT_TRUE(database.query(handmade({0, 9}, 1)).empty());
  database.insert(handmade({0, 0}, 1));
  EXPECT_TRUE(database.query(MapDescription{}).empty());
}

TEST(DescribeMap, WithoutUsablePointsHasNoFeatures) {
  for (const Points& points : {Points{}, Points{{1e9F, 0, 0}, {0, -1e9F, 0}}}) {
    const MapDescription d = describe_map({0, 0}, points, {});
    EXPECT_TRUE(d.descriptors.empty());
    EXPECT_TRUE(d.keypoints.empty());
  }
}

// A file of somebody else may have a right checksum: a NaN beside a good number, and an angle that
// is none, ended in a segmentation fault.
TEST(LoopDatabase, RefusesNumbersThatNoMapHas) {
  MapDescription good;
  good.keypoints = {{1, 2}, {3, 4}};
  good.orientations = {0.5F, 6.0F};
  good.descriptors.resize(2);
  const auto read_back = [](const MapDescription& description) {
    LoopDatabase database{LoopClosureOptions{}};
    database.insert(description);
    return LoopDatabase::from_bytes(database.bytes(), "file", {}).descriptions().size();
  };
  EXPECT_EQ(read_back(good), 1U);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const Eigen::Vector2f& keypoint :
       {Eigen::Vector2f(kNan, 1), Eigen::Vector2f(1, kNan), Eigen::Vector2f(1, 1e30F)}) {
    MapDescription bad = good;
    bad.keypoints[1] = keypoint;
    EXPECT_THROW((void)read_back(bad), InputError) << keypoint.transpose();
  }
  for (const float orientation : {kNan, 1e30F, -8.0F}) {
    MapDescription bad = good;
    bad.orientations[0] = orientation;
    EXPECT_THROW((void)read_back(bad), InputError) << orientation;
  }
  for (const int axis : {0, 1, 2}) {
    MapDescription bad = good;
    bad.T_ground_map.translation[axis] = static_cast<double>(kNan);
    EXPECT_THROW((void)read_back(bad), InputError) << axis;
  }
}

TEST(DescribeMap, OneOccupiedCellHasFeaturesThereOrNone) {
  for (const Points& points : {Points{{1, 1, 1}}, Points(500, Eigen::Vector3f(1, 1, 1)),
                               Points{{1e9F, 0, 0}, {1, 1, 0}}}) {
    const MapDescription d = describe_map({0, 0}, points, {});
    EXPECT_EQ(d.descriptors.size(), d.keypoints.size());
    EXPECT_EQ(d.orientations.size(), d.keypoints.size());
    for (const Eigen::Vector2f& p : d.keypoints) {
      EXPECT_LT((p - Eigen::Vector2f(1, 1)).norm(), 1.0F);
    }
  }
}

TEST(DescribeMap, IsTheSameEveryTime) {
  const Points points = town(3);
  const MapDescription a = describe_map({0, 0}, points, {}), b = describe_map({0, 0}, points, {});
  EXPECT_EQ(a.keypoints, b.keypoints);
  EXPECT_EQ(a.orientations, b.orientations);
  EXPECT_EQ(a.descriptors, b.descriptors);
  EXPECT_EQ(a.T_ground_map.matrix(), b.T_ground_map.matrix());
}

}  // namespace
}  // namespace groundloop
