// odometry_quality.csv: how well odometry went, one row a scan.
#pragma once

#include <filesystem>
#include <vector>

#include "frontend/odometry/odometry_quality.hpp"

namespace groundloop {

/// Columns: scan, state, piece, correspondences, inlier_share, residual_m, sigma_tx ... sigma_rz
/// (m, rad; scan frame), then doubt, weakest (of tx ... rz), point_sigma_m, constraint, fit,
/// deviation_m, deviation_rad, converged (ScanQuality). A field is empty where the scan was not
/// registered.
void write_odometry_quality(const std::filesystem::path& file,
                            const std::vector<ScanQuality>& scans);

}  // namespace groundloop
