// Messages of sensor_msgs/PointCloud2. The first byte chooses the encoding: ROS 1, else CDR.
#include "frontend/recordings/point_cloud2.hpp"

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/point_files.hpp"

GROUNDLOOP_FUZZ_TARGET(point_cloud2) {
  if (input.empty()) return;
  const auto encoding =
      input[0] == std::byte{'1'} ? recordings::Encoding::ros1 : recordings::Encoding::cdr;
  const Input message = input.subspan(1);
  const auto header = recordings::parse_cloud_header(message, encoding);
  const recordings::Cloud cloud = recordings::parse_cloud(message, encoding, "input");
  FUZZ_PROMISE(header.has_value() && header->stamp == cloud.header.stamp);
  FUZZ_PROMISE(is_stamp(cloud.header.stamp));
  decode_table(cloud.table.layout, cloud.data, cloud.table.count, cloud.header.stamp);
}
