// Values of records in memory: a typed view of one field over all records, checked once against the
// bytes that are there, so that loops over points need no checks of their own.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include "frontend/core/scan.hpp"
#include "frontend/recordings/point_layout.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {

static_assert(std::endian::native == std::endian::little, "readers assume a little-endian machine");

template <typename T>
T load(const std::byte* at, bool swap) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// Calls f with a value of the type's C++ type.
template <typename F>
auto dispatch(FieldType type, F&& f) {
  switch (type) {
    case FieldType::int8:
      return f(std::int8_t{});
    case FieldType::uint8:
      return f(std::uint8_t{});
    case FieldType::int16:
      return f(std::int16_t{});
    case FieldType::uint16:
      return f(std::uint16_t{});
    case FieldType::int32:
      return f(std::int32_t{});
    case FieldType::uint32:
      return f(std::uint32_t{});
    case FieldType::int64:
      return f(std::int64_t{});
    case FieldType::uint64:
      return f(std::uint64_t{});
    case FieldType::float32:
      return f(float{});
    case FieldType::float64:
      break;
  }
  return f(double{});
}

[[nodiscard]] inline bool is_float(FieldType type) {
  return type == FieldType::float32 || type == FieldType::float64;
}

/// The values of one field, one a record.
struct Column {
  const std::byte* begin = nullptr;
  std::size_t stride = 0;
  bool swap = false;
  template <typename T>
  [[nodiscard]] T at(std::size_t i) const {
    return load<T>(begin + i * stride, swap);
  }
};

struct Coordinates {
  Column x, y, z;
  FieldType type = FieldType::float32;
};

/// Throws InputError beginning with `where` unless the field's last value ends within the data.
[[nodiscard]] Column column(const PointLayout& layout, const PointField& field,
                            std::span<const std::byte> data, std::size_t count,
                            const std::string& where);
/// Throws InputError where x, y or z is missing, or they are not all float32 or all float64.
[[nodiscard]] Coordinates coordinates(const PointLayout& layout, std::span<const std::byte> data,
                                      std::size_t count, const std::string& where);

/// Point i; false where it is no return.
template <typename T>
[[nodiscard]] bool load_point(const Coordinates& c, std::size_t i, Eigen::Vector3f& p) {
  p = Eigen::Vector3f(static_cast<float>(c.x.at<T>(i)), static_cast<float>(c.y.at<T>(i)),
                      static_cast<float>(c.z.at<T>(i)));
  return is_return(p.x(), p.y(), p.z());
}

[[nodiscard]] inline bool is_valid(const Coordinates& c, std::size_t i) {
  Eigen::Vector3f p;
  return c.type == FieldType::float32 ? load_point<float>(c, i, p) : load_point<double>(c, i, p);
}

/// value - zero without loss. Unsigned counters of 32 and 64 bits that have wrapped in between are
/// near each other.
template <typename T>
[[nodiscard]] double difference(T value, T zero) {
  if constexpr (std::is_same_v<T, std::uint32_t>) {
    return static_cast<double>(static_cast<std::int32_t>(value - zero));
  } else if constexpr (std::is_integral_v<T>) {
    return static_cast<double>(static_cast<std::int64_t>(static_cast<std::uint64_t>(value) -
                                                         static_cast<std::uint64_t>(zero)));
  } else {
    return static_cast<double>(value) - static_cast<double>(zero);
  }
}

}  // namespace groundloop::recordings
