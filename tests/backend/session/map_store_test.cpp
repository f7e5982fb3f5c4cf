#include "backend/session/map_store.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::TemporaryFolder;

class MapStoreTest : public ::testing::Test {
 protected:
  MapStoreTest() { std::filesystem::create_directories(folder_ / "local_maps"); }

  // A map whose one point tells its number.
  static LocalMap map(int id) {
    LocalMap map;
    map.id = id;
    map.points = {{static_cast<float>(id), 2.0F, 3.0F}};
    return map;
  }

  static float number_of(const std::shared_ptr<StoredMap>& map) { return map->points()[0].x(); }

  TemporaryFolder folder_;
  SessionFolder session_{folder_.path()};
  MapStore store_{session_, RegistrationOptions{}, 2};
};

TEST_F(MapStoreTest, GivesBackWhatWasPutAlsoFromDisk) {
  for (int id = 0; id < 5; ++id) store_.put(map(id));
  MapStore other(session_, RegistrationOptions{}, 1);
  for (int id = 0; id < 5; ++id) {
    EXPECT_EQ(number_of(store_.get(id)), static_cast<float>(id));
    EXPECT_EQ(number_of(other.get(id)), static_cast<float>(id));
  }
}

TEST_F(MapStoreTest, KeepsTheLatestUsedAndReadsNoOther) {
  store_.put(map(0));
  store_.put(map(1));
  const std::shared_ptr<StoredMap> first = store_.get(0);
  store_.put(map(2));  // 1 goes: 0 was used since
  std::filesystem::remove_all(folder_ / "local_maps");
  EXPECT_EQ(store_.get(0), first);
  EXPECT_EQ(number_of(store_.get(2)), 2.0F);
  EXPECT_THROW((void)store_.get(1), InputError);
  // What somebody holds outlives the cache.
  EXPECT_EQ(number_of(first), 0.0F);
}

TEST_F(MapStoreTest, NamesTheFileThatIsMissingOrBroken) {
  const auto message = [&](int id) {
    try {
      (void)store_.get(id);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message(7).find("local_maps/000007.pcd"), std::string::npos);
  std::ofstream(session_.local_map(8)) << "VERSION .7\nFIELDS x y\n";
  EXPECT_NE(message(8).find("local_maps/000008.pcd"), std::string::npos);
}

}  // namespace
}  // namespace groundloop
