// Local maps of a session (binary PCD of our own), and point clouds that are named by users.
#include "frontend/core/error.hpp"
#include "frontend/core/pcd.hpp"
#include "frontend/recordings/point_cloud_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(local_map) {
  const bool ply = text_of(input).starts_with("ply");
  const auto file = scratch_file(ply ? "map.ply" : "map.pcd", text_of(input));
  try {
    for (const Eigen::Vector3f& p : read_point_cloud(file)) FUZZ_PROMISE(p.allFinite());
  } catch (const InputError&) {
  }
  const Points points = read_pcd(file);
  for (const Eigen::Vector3f& p : points) FUZZ_PROMISE(p.allFinite());
  const auto again = scratch_folder() / "again.pcd";
  write_pcd(again, points);
  FUZZ_PROMISE(read_pcd(again) == points);
}
