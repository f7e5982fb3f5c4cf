// The two overlapping real scans with a known relative pose; empty where the data are absent.
#pragma once

#include <fstream>
#include <string>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop::testing {

struct RegistrationPair {
  Points source;
  Points target;
  Pose T_target_source;
};

// Reads the shared pair's own layout only: binary floats, x y z first.
inline Points read_shared_ply(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::size_t count = 0;
  std::size_t properties = 0;
  while (std::getline(in, line) && line != "end_header") {
    if (line.rfind("element vertex", 0) == 0) count = std::stoul(line.substr(15));
    if (line.rfind("property float", 0) == 0) ++properties;
  }
  Points points;
  std::vector<float> record(properties);
  for (std::size_t i = 0; i < count; ++i) {
    in.read(reinterpret_cast<char*>(record.data()),
            static_cast<std::streamsize>(properties * sizeof(float)));
    points.emplace_back(record[0], record[1], record[2]);
  }
  return points;
}

inline RegistrationPair registration_pair() {
  const std::string folder = std::string(GROUNDLOOP_SHARED_DATA) + "/registration/";
  RegistrationPair pair;
  std::ifstream in(folder + "T_target_source.txt");
  if (!in) return pair;
  Eigen::Matrix4d m;
  for (int i = 0; i < 16; ++i) in >> m(i / 4, i % 4);
  pair.T_target_source =
      Pose(Eigen::Matrix3d(m.topLeftCorner<3, 3>()), Eigen::Vector3d(m.topRightCorner<3, 1>()));
  pair.source = read_shared_ply(folder + "source.ply");
  pair.target = read_shared_ply(folder + "target.ply");
  return pair;
}

}  // namespace groundloop::testing
