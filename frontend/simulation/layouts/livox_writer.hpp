// A scan as a livox_ros_driver/CustomMsg message, serialised as ROS 1 does.
#pragma once

#include <string>

#include "frontend/core/scan.hpp"
#include "frontend/simulation/layouts/byte_writer.hpp"

namespace groundloop::layouts {

/// Times are counted in nanoseconds from the stamp. Throws InputError for such as are before it.
[[nodiscard]] ByteWriter livox_message(const Scan& scan, std::uint32_t sequence);

/// The message's definition, as bags carry it, and its checksum by ROS' rule.
[[nodiscard]] const std::string& livox_definition();
inline constexpr const char* kLivoxMd5 = "e4d6829bdfe657cb6c21a746c86b21a6";

}  // namespace groundloop::layouts
