#include "frontend/recordings/attribute_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "frontend/recordings/point_columns.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::array kIntensity = {"intensity", "Intensity", "i", "scalar_Intensity", "signal"};
constexpr std::array kReflectivity = {"reflectivity", "Reflectivity", "reflectance"};
// `line` is Livox's and Aeva's `line_index`, `channel` Nebula's; `laser` is Boreas'.
constexpr std::array kRing = {"ring", "Ring", "channel", "laser", "laser_id", "line", "line_index"};
constexpr std::array kReturn = {"return_number", "ReturnNumber", "return_num", "ret_id"};
// Bits 4 and 5 of Livox's tag count the echoes of a shot from 0.
constexpr const char* kLivoxTag = "tag";

// A number of any type as another one; what does not fit becomes zero.
template <typename To, typename From>
To fitted(From value) {
  if constexpr (std::is_floating_point_v<To>) {
    return static_cast<To>(value);
  } else {
    const auto real = static_cast<double>(value);
    const bool fits = real >= 0.0 && real <= static_cast<double>(std::numeric_limits<To>::max());
    return fits ? static_cast<To>(real) : To{};
  }
}

template <typename To>
std::vector<To> gather(const PointLayout& layout, const PointField& field,
                       std::span<const std::byte> data, std::size_t count,
                       const std::vector<std::uint32_t>& records, const std::string& where) {
  const Column values = column(layout, field, data, count, where);
  std::vector<To> list(records.size());
  dispatch(field.type, [&](auto type) {
    for (std::size_t i = 0; i < records.size(); ++i)
      list[i] = fitted<To>(values.at<decltype(type)>(records[i]));
  });
  return list;
}

}  // namespace

AttributeFields find_attribute_fields(const PointLayout& layout) {
  AttributeFields fields;
  fields.intensity = layout.find_first(kIntensity);
  fields.reflectivity = layout.find_first(kReflectivity);
  fields.ring = layout.find_first(kRing);
  fields.return_number = layout.find_first(kReturn);
  if (fields.return_number == nullptr && layout.find("line") != nullptr) {
    const PointField* tag = layout.find(kLivoxTag);
    if (tag != nullptr && tag->type == FieldType::uint8) fields.return_number = tag;
  }
  return fields;
}

PointAttributes read_attributes(const PointLayout& layout, std::span<const std::byte> data,
                                std::size_t count, const AttributeSet& wanted,
                                const std::vector<std::uint32_t>& records,
                                const std::string& where) {
  const AttributeFields fields = find_attribute_fields(layout);
  PointAttributes attributes;
  const auto read = [&](bool want, const PointField* field, auto& list) {
    using To = typename std::remove_reference_t<decltype(list)>::value_type;
    if (want && field != nullptr) list = gather<To>(layout, *field, data, count, records, where);
  };
  read(wanted.intensity, fields.intensity, attributes.intensity);
  read(wanted.reflectivity, fields.reflectivity, attributes.reflectivity);
  read(wanted.ring, fields.ring, attributes.ring);
  read(wanted.return_number, fields.return_number, attributes.return_number);
  if (wanted.return_number && fields.return_number != nullptr &&
      fields.return_number->name == kLivoxTag) {
    for (std::uint8_t& tag : attributes.return_number)
      tag = static_cast<std::uint8_t>((tag >> 4U & 3U) + 1U);
  }
  return attributes;
}

}  // namespace groundloop::recordings
