// livox_ros_driver/CustomMsg, livox_ros_driver2/CustomMsg and their ROS 2 forms: the same bytes in
// both generations of driver. Times are nanoseconds from the message's time base, which its header
// repeats. Written after the published message definitions; no recorded sample was at hand.
#pragma once

#include "frontend/recordings/point_cloud2.hpp"

namespace groundloop::recordings {

[[nodiscard]] bool is_livox_message(const std::string& type);

/// As parse_cloud_header and parse_cloud for PointCloud2.
[[nodiscard]] std::optional<CloudHeader> parse_livox_header(std::span<const std::byte> message,
                                                            Encoding encoding);
[[nodiscard]] Cloud parse_livox(std::span<const std::byte> message, Encoding encoding,
                                const std::string& where);

}  // namespace groundloop::recordings
