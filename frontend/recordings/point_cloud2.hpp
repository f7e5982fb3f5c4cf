// sensor_msgs/PointCloud2 as ROS 1 serialises it and as CDR does: the one decoder for all bags.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frontend/recordings/message_reader.hpp"
#include "frontend/recordings/point_layout.hpp"

namespace groundloop::recordings {

/// What stands before the fields of a message.
struct CloudHeader : MessageHeader {
  std::uint32_t height = 0, width = 0;
};
/// Nothing where the bytes, which may be the first ones of a message only, are too few or are no
/// CDR.
[[nodiscard]] std::optional<CloudHeader> parse_cloud_header(std::span<const std::byte> message,
                                                            Encoding encoding);

struct Cloud {
  CloudHeader header;
  PointTable table;                 ///< offsets are into `data`
  std::span<const std::byte> data;  ///< part of the message, or of `storage`
  std::vector<std::byte> storage;   ///< rows without the padding between them, where there was any
};
/// Throws InputError beginning with `where`: a message that is cut off, a field beyond the point's
/// step, sizes that contradict each other or the data.
[[nodiscard]] Cloud parse_cloud(std::span<const std::byte> message, Encoding encoding,
                                const std::string& where);

}  // namespace groundloop::recordings
