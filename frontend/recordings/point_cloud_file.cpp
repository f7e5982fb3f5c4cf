#include "frontend/recordings/point_cloud_file.hpp"

#include <string>

#include "frontend/core/error.hpp"
#include "frontend/recordings/point_files.hpp"
#include "frontend/recordings/point_layout.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop {

Points read_point_cloud(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string ending = file.extension().string();
  if (ending != ".pcd" && ending != ".ply")
    throw InputError(name + ": unknown ending '" + ending + "'; a point cloud is .pcd or .ply");
  std::vector<std::byte> bytes;
  recordings::read_file_into(file, bytes);
  const recordings::PointTable table =
      ending == ".pcd" ? recordings::parse_pcd(bytes, name) : recordings::parse_ply(bytes, name);
  Points points = recordings::decode_points(table.layout, bytes, table.count, 0, {}, name).points;
  if (points.empty()) throw InputError(name + ": holds no point");
  return points;
}

}  // namespace groundloop
