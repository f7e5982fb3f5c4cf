// A scan as a sensor_msgs/PointCloud2 message, serialised as ROS 1 does or in CDR.
#pragma once

#include <string>

#include "frontend/core/scan.hpp"
#include "frontend/simulation/layouts/byte_writer.hpp"

namespace groundloop::layouts {

/// The form of the per-point times, where a scan has them: each is in use by some LiDAR's driver.
enum class TimeField {
  t_ns,         ///< `t`, uint32, ns from the stamp (needs times that are not negative)
  time_s,       ///< `time`, float32, s from the stamp
  timestamp_s,  ///< `timestamp`, float64, absolute s
};

/// Throws InputError where the times do not fit the form.
[[nodiscard]] ByteWriter ros1_message(const Scan& scan, TimeField times, std::uint32_t sequence);
[[nodiscard]] ByteWriter cdr_message(const Scan& scan, TimeField times);

/// The message's definition, as bags carry it.
[[nodiscard]] const std::string& point_cloud2_definition(bool ros1);

}  // namespace groundloop::layouts
