#include "frontend/recordings/point_layout.hpp"

#include <algorithm>
#include <array>

#include "frontend/core/error.hpp"
#include "frontend/recordings/attribute_fields.hpp"
#include "frontend/recordings/point_columns.hpp"

namespace groundloop::recordings {

std::size_t size_of(FieldType type) {
  return dispatch(type, [](auto value) { return sizeof(value); });
}

const char* to_string(FieldType type) {
  constexpr std::array<const char*, 10> names = {"int8",   "uint8", "int16",  "uint16",  "int32",
                                                 "uint32", "int64", "uint64", "float32", "float64"};
  return names.at(static_cast<std::size_t>(type));
}

void PointLayout::append(std::string name, FieldType type, std::size_t count) {
  fields.push_back({std::move(name), type, packed_size, 0});
  packed_size += size_of(type) * count;
}

void PointLayout::set_records(std::size_t begin) {
  for (PointField& field : fields) {
    field.offset += begin;
    field.stride = packed_size;
  }
}

const PointField* PointLayout::find(const std::string& name) const {
  const auto it = std::find_if(fields.begin(), fields.end(),
                               [&](const PointField& field) { return field.name == name; });
  return it == fields.end() ? nullptr : &*it;
}

const PointField* PointLayout::find_first(std::span<const char* const> names) const {
  for (const char* name : names) {
    if (const PointField* field = find(name)) return field;
  }
  return nullptr;
}

std::vector<std::string> PointLayout::described() const {
  std::vector<std::string> texts;
  for (const PointField& field : fields) texts.push_back(field.name + " " + to_string(field.type));
  return texts;
}

AttributeSet PointLayout::attributes() const {
  const AttributeFields found = find_attribute_fields(*this);
  return {found.intensity != nullptr, found.reflectivity != nullptr, found.ring != nullptr,
          found.return_number != nullptr};
}

PointLayout float_records(std::span<const char* const> names) {
  PointLayout layout;
  for (const char* name : names) layout.append(name, FieldType::float32);
  layout.set_records(0);
  return layout;
}

Column column(const PointLayout& layout, const PointField& field, std::span<const std::byte> data,
              std::size_t count, const std::string& where) {
  const std::size_t size = size_of(field.type);
  const std::size_t before = count == 0 ? 0 : count - 1;
  const bool fits = field.offset <= data.size() && size <= data.size() - field.offset &&
                    (before == 0 || (field.stride > 0 &&
                                     before <= (data.size() - field.offset - size) / field.stride));
  if (count > 0 && !fits) {
    throw InputError(where + ": " + std::to_string(data.size()) +
                     " bytes of points are too few for " + std::to_string(count) +
                     " records with field '" + field.name +
                     "'; it is cut off or its description is wrong");
  }
  return {data.data() + (count == 0 ? 0 : field.offset), field.stride, layout.big_endian};
}

Coordinates coordinates(const PointLayout& layout, std::span<const std::byte> data,
                        std::size_t count, const std::string& where) {
  std::array<const PointField*, 3> fields{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string name(1, static_cast<char>('x' + k));
    fields[k] = layout.find(name);
    if (fields[k] == nullptr) {
      std::string present;
      for (const std::string& f : layout.described()) present += (present.empty() ? "" : ", ") + f;
      throw InputError(where + ": points have no field '" + name + "'; found are " + present);
    }
    if (!is_float(fields[k]->type) || fields[k]->type != fields[0]->type) {
      throw InputError(where + ": field '" + name + "' is " + to_string(fields[k]->type) +
                       "; x, y and z must be all float32 or all float64");
    }
  }
  return {column(layout, *fields[0], data, count, where),
          column(layout, *fields[1], data, count, where),
          column(layout, *fields[2], data, count, where), fields[0]->type};
}

}  // namespace groundloop::recordings
