// What the records of headerless files of float32 values are. Lengths alone do not tell: a file of
// 20-byte records often fits 16-byte ones, too, and its points are then nonsense.
//
// The evidence is that values of one field are nearer to each other than to those of another. The
// mean of sqrt|v[i] - v[i + k]| over the stream of values is least where k is the number of fields
// (or a multiple), whatever the order of the points: sqrt|a - b| is a distance of negative type, so
// no mixture of two fields is as close to itself as the fields are on the average (Szekely and
// Rizzo, J. Stat. Plan. Inference 2013).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "frontend/recordings/point_layout.hpp"

namespace groundloop::recordings {

struct BinLayout {
  std::vector<std::string> fields;
  std::string evidence;  ///< a sentence; empty where lengths left no choice
  [[nodiscard]] PointLayout layout() const;
};

/// Fields of the files' records, x, y and z first: x y z intensity, and where a fifth value is a
/// whole number a ring, and behind it a time. `asked`: names separated by commas, which are taken.
/// Throws InputError where x, y or z is not among those.
[[nodiscard]] BinLayout choose_bin_layout(const std::vector<std::filesystem::path>& files,
                                          const std::string& asked);

}  // namespace groundloop::recordings
