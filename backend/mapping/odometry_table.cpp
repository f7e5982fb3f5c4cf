#include "backend/mapping/odometry_table.hpp"

#include <array>
#include <cmath>
#include <string>

#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace {

constexpr std::array<const char*, 6> kDirections{"tx", "ty", "tz", "rx", "ry", "rz"};

std::string row_of(const ScanQuality& q, std::size_t scan) {
  // Until odometry is cut into pieces there is one.
  std::string row = std::to_string(scan) + "," + to_string(q.state) + ",0";
  const bool registered = q.state != OdometryState::predicted && q.correspondences > 0.0;
  const auto add = [&](double value) {
    row += ',';
    if (registered && std::isfinite(value)) row += to_text(value);
  };
  add(q.correspondences);
  add(q.inlier_share);
  add(q.residual);
  for (const double sigma : q.sigma) add(sigma);
  row += std::string(",") + to_string(q.doubt) + ",";
  if (registered) row += kDirections.at(static_cast<std::size_t>(q.weakest));
  for (const double value : {q.point_sigma, q.constraint, q.fit, q.deviation, q.deviation_angle})
    add(value);
  add(q.converged);
  return row + "\n";
}

}  // namespace

void write_odometry_quality(const std::filesystem::path& file,
                            const std::vector<ScanQuality>& scans) {
  std::string text = "scan,state,piece,correspondences,inlier_share,residual_m";
  for (const char* direction : kDirections) text += std::string(",sigma_") + direction;
  text += ",doubt,weakest,point_sigma_m,constraint,fit,deviation_m,deviation_rad,converged\n";
  for (std::size_t i = 0; i < scans.size(); ++i) text += row_of(scans[i], i);
  write_text_atomically(file, text);
}

}  // namespace groundloop
