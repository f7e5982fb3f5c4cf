// Point records as files and messages describe them (named fields of a type at an offset), and
// their decoding into scans. PCD, PLY, PointCloud2 and binary dumps are all read through this.
//
// Per-point times come under several names, in several units, from several zeros; what they are is
// inferred once from data (TimeModel), printed, and then applied to every scan.
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
  /// "x float32, y float32, ..." for messages.
  [[nodiscard]] std::vector<std::string> described() const;
};

/// Points of a file: where they lie in its bytes.
struct PointTable {
  PointLayout layout;
  std::size_t count = 0;
};

/// How a time field becomes seconds from the scan's stamp.
struct TimeModel {
  enum class Zero { stamp, epoch, first_point };
  std::string field;
  FieldType type = FieldType::float32;
  double seconds_per_unit = 1.0;
  std::string unit;  ///< "s", "ms", "us", "ns", "share of the scan"
  Zero zero = Zero::stamp;
  /// E.g. "field 't' (uint32), ns from the stamp".
  [[nodiscard]] std::string described() const;
};

/// The time field of a layout: t, time, timestamp, time_stamp, timestamps, offset_time, time_offset
/// and alike; null where there is none.
[[nodiscard]] const PointField* find_time_field(const PointLayout& layout);

/// Infers what the time field means from one scan's records; nothing where there is no such field
/// or all its values are equal. `period` is the recording's median scan interval.
[[nodiscard]] std::optional<TimeModel> infer_time_model(const PointLayout& layout,
                                                        std::span<const std::byte> data,
                                                        std::size_t count, Nanoseconds stamp,
                                                        Nanoseconds period);

/// The model that fits both scans: a clock of its own shows only once it is away from zero.
[[nodiscard]] std::optional<TimeModel> merge(const std::optional<TimeModel>& a,
                                             const std::optional<TimeModel>& b);

/// Decodes `count` records: valid points and, with a model, their times; points whose time is not
/// finite or more than a minute from the scan go with it. Throws InputError beginning with `where`
/// where x, y or z is missing, the data are too short, or the model's field is missing.
[[nodiscard]] Scan decode_points(const PointLayout& layout, std::span<const std::byte> data,
                                 std::size_t count, Nanoseconds stamp,
                                 const std::optional<TimeModel>& times, const std::string& where);

}  // namespace groundloop::recordings
