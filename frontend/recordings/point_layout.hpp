// Point records as files and messages describe them (named fields of a type at an offset), and
// their decoding into scans. PCD, PLY, PointCloud2 and binary dumps are all read through this.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frontend/core/scan.hpp"

namespace groundloop::recordings {

enum class FieldType : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64
};
[[nodiscard]] std::size_t size_of(FieldType type);
[[nodiscard]] const char* to_string(FieldType type);

/// Value i of a field lies at byte offset + i * stride.
struct PointField {
  std::string name;
  FieldType type = FieldType::float32;
  std::size_t offset = 0;
  std::size_t stride = 0;
};

struct PointLayout {
  std::vector<PointField> fields;
  bool big_endian = false;
  std::size_t packed_size = 0;  ///< bytes of the record that append() has built

  /// Appends a field of `count` values, of which the first is read, behind the last one.
  void append(std::string name, FieldType type, std::size_t count = 1);
  /// Makes a table of append()ed records one after the other that begins at byte `begin`.
  void set_records(std::size_t begin);
  [[nodiscard]] const PointField* find(const std::string& name) const;
  /// The first of several names that is there; null where none is.
  [[nodiscard]] const PointField* find_first(std::span<const char* const> names) const;
  /// "x float32, y float32, ..." for messages.
  [[nodiscard]] std::vector<std::string> described() const;
  /// Attributes that have a field of a usual name.
  [[nodiscard]] AttributeSet attributes() const;
};

/// Records of float32 values of these names, one after the other from byte 0.
[[nodiscard]] PointLayout float_records(std::span<const char* const> names);

/// Points of a file: where they lie in its bytes.
struct PointTable {
  PointLayout layout;
  std::size_t count = 0;
};

struct TimeModel;

/// What is wanted of records beside the points.
struct DecodeRequest {
  /// What the time field means; null: no times.
  const TimeModel* times = nullptr;
  AttributeSet attributes;
  /// Where given: the number of the record that each point of the scan came from.
  std::vector<std::uint32_t>* records = nullptr;
};

/// Decodes `count` records: valid points and what the request asks for. Points whose time is not
/// finite or cannot be of this scan are left out. Throws InputError beginning with `where` where x,
/// y or z is missing, the data are too short, or the model's field is missing.
[[nodiscard]] Scan decode_points(const PointLayout& layout, std::span<const std::byte> data,
                                 std::size_t count, Nanoseconds stamp, const DecodeRequest& request,
                                 const std::string& where);

}  // namespace groundloop::recordings
