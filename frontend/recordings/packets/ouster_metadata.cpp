#include "frontend/recordings/packets/ouster_metadata.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "frontend/core/error.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostRows = 1024, kMostColumns = 8192;

// A value by its name, wherever the metadata's generation keeps it; null where it is not.
const Json* find(const Json& root, const char* key) {
  if (root.contains(key)) return &root[key];
  for (const char* group : {"beam_intrinsics", "lidar_intrinsics", "sensor_info", "config_params",
                            "lidar_data_format", "data_format"}) {
    if (root.contains(group) && root[group].is_object() && root[group].contains(key))
      return &root[group][key];
  }
  return nullptr;
}

std::vector<double> angles(const Json& root, const char* key, const std::string& where) {
  const Json* list = find(root, key);
  if (list == nullptr || !list->is_array() || list->empty() || list->size() > kMostRows)
    throw InputError(where + ": has no list '" + key + "'; is it an Ouster sensor's metadata?");
  std::vector<double> values;
  for (const Json& value : *list) {
    if (!value.is_number()) throw InputError(where + ": '" + key + "' holds what is no number");
    values.push_back(value.get<double>() * kRadiansPerDegree);
  }
  return values;
}

std::size_t count(const Json& root, const char* key, std::size_t otherwise) {
  const Json* value = find(root, key);
  return value != nullptr && value->is_number_unsigned() ? value->get<std::size_t>() : otherwise;
}

std::string text(const Json& root, const char* key) {
  const Json* value = find(root, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

// "1024x10": columns a turn, turns a second.
std::size_t columns_of_mode(const std::string& mode) {
  return static_cast<std::size_t>(std::strtoul(mode.c_str(), nullptr, 10));
}

Pose sensor_from_lidar(const Json& root, OusterMetadata& metadata, const std::string& where) {
  const Json* matrix = find(root, "lidar_to_sensor_transform");
  if (matrix == nullptr) {
    metadata.assumed.emplace_back("lidar_to_sensor_transform");
    // Half a turn about z, 36.18 mm above the base: of all models of the first generations.
    return {Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0), Eigen::Vector3d(0.0, 0.0, 0.03618)};
  }
  double rows[12] = {};
  if (!matrix->is_array() || matrix->size() != 16)
    throw InputError(where + ": 'lidar_to_sensor_transform' is no list of 16 numbers");
  for (std::size_t i = 0; i < 12; ++i) {
    if (!(*matrix)[i].is_number())
      throw InputError(where + ": 'lidar_to_sensor_transform' holds what is no number");
    rows[i] = (*matrix)[i].get<double>() * (i % 4 == 3 ? 1e-3 : 1.0);  // millimetres
  }
  return pose_from_matrix(rows, where + ": lidar_to_sensor_transform: ");
}

// Published origins of the beams by model, for metadata that do not hold them.
double usual_beam_offset(const std::string& product) {
  if (product.starts_with("OS-0")) return 0.02767;
  if (product.starts_with("OS-2")) return 0.013762;
  if (product.starts_with("OS-1")) return 0.015806;
  return 0.012163;  // the first OS-1
}

}  // namespace

bool is_ouster_metadata(const std::string& json) {
  return json.find("beam_altitude_angles") != std::string::npos;
}

OusterMetadata parse_ouster_metadata(const std::string& json, const std::string& where) {
  const Json root = Json::parse(json, nullptr, false);
  if (!root.is_object()) throw InputError(where + ": is no JSON object that can be read");
  OusterMetadata metadata;
  metadata.elevations = angles(root, "beam_altitude_angles", where);
  metadata.azimuths = angles(root, "beam_azimuth_angles", where);
  metadata.rows = metadata.elevations.size();
  if (metadata.azimuths.size() != metadata.rows ||
      count(root, "pixels_per_column", metadata.rows) != metadata.rows)
    throw InputError(where + ": its lists of beams differ in length");
  metadata.product = text(root, "prod_line");
  metadata.profile = text(root, "udp_profile_lidar");
  if (metadata.profile.empty()) metadata.profile = "LEGACY";
  metadata.columns_per_packet = count(root, "columns_per_packet", 16);
  metadata.columns_per_frame =
      count(root, "columns_per_frame", columns_of_mode(text(root, "lidar_mode")));
  if (metadata.columns_per_frame == 0 || metadata.columns_per_frame > kMostColumns ||
      metadata.columns_per_packet == 0 || metadata.columns_per_packet > 128)
    throw InputError(where + ": tells neither columns_per_frame nor a lidar_mode such as 1024x10");
  const Json* offset = find(root, "lidar_origin_to_beam_origin_mm");
  if (offset != nullptr && offset->is_number()) {
    metadata.beam_offset = 1e-3 * offset->get<double>();
  } else {
    metadata.beam_offset = usual_beam_offset(metadata.product);
    metadata.assumed.emplace_back("lidar_origin_to_beam_origin_mm");
  }
  metadata.T_sensor_lidar = sensor_from_lidar(root, metadata, where);
  return metadata;
}

}  // namespace groundloop::recordings
