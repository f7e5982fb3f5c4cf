// Under which names drivers and datasets keep what a scan knows as intensity, reflectivity, ring
// and return number, and the lists filled from them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "frontend/recordings/point_layout.hpp"

namespace groundloop::recordings {

struct AttributeFields {
  const PointField* intensity = nullptr;
  const PointField* reflectivity = nullptr;
  const PointField* ring = nullptr;
  const PointField* return_number = nullptr;
};
[[nodiscard]] AttributeFields find_attribute_fields(const PointLayout& layout);

/// The attributes wanted that the layout has, of the given records, in their order. Throws
/// InputError beginning with `where` where the data are too short for `count` records.
[[nodiscard]] PointAttributes read_attributes(const PointLayout& layout,
                                              std::span<const std::byte> data, std::size_t count,
                                              const AttributeSet& wanted,
                                              const std::vector<std::uint32_t>& records,
                                              const std::string& where);

}  // namespace groundloop::recordings
