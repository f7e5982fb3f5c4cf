// The tables that a session has beside its core: how odometry went, the pieces it is in, closures
// between submaps, and how certain the solution is. A session may lack any of them. Columns are
// found by their names in the header, so that a table may gain some.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "frontend/core/pose.hpp"

namespace groundloop::apps {

/// One row of odometry_quality.csv.
struct ScanQuality {
  std::size_t scan = 0;
  std::string state;  ///< good, weak, lost or predicted
  int piece = 0;
  double correspondences = 0.0;
  double inlier_share = 0.0;
  double residual_m = 0.0;
  /// Standard deviations of the registration along and about x, y, z of the scan (m, rad).
  std::array<double, 6> sigma{};
};

/// One row of pieces.csv: a stretch of odometry between losses.
struct OdometryPiece {
  int piece = 0;
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;  ///< included
  int frame = 0;              ///< the piece whose world it is in
  std::string joined_by, reason;
};

/// One row of scan_closures.csv: a closure between submaps.
struct ScanClosure {
  std::size_t reference_scan = 0;
  std::size_t query_scan = 0;
  std::string source, status;
  double overlap = 0.0;
  double rmse_m = 0.0;
  double weight = 0.0;
  Pose T_query_reference;
};

/// One row of uncertainty.csv: the marginal covariance of a map's pose against the first map,
/// perturbed on the right, order tx ty tz rx ry rz (m, rad).
struct MapUncertainty {
  int map = 0;
  Matrix6d covariance = Matrix6d::Zero();
};

/// Each throws InputError naming file, line and what is wrong; a file that is not there has no
/// rows.
[[nodiscard]] std::vector<ScanQuality> read_odometry_quality(const std::filesystem::path& file);
[[nodiscard]] std::vector<OdometryPiece> read_pieces(const std::filesystem::path& file);
[[nodiscard]] std::vector<ScanClosure> read_scan_closures(const std::filesystem::path& file);
[[nodiscard]] std::vector<MapUncertainty> read_uncertainty(const std::filesystem::path& file);

}  // namespace groundloop::apps
