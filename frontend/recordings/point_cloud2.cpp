#include "frontend/recordings/point_cloud2.hpp"

#include <array>

#include "frontend/core/error.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::size_t kMostFields = 1000;

CloudHeader read_header(MessageReader& reader) {
  CloudHeader header;
  static_cast<MessageHeader&>(header) = reader.header();
  header.height = reader.number<std::uint32_t>();
  header.width = reader.number<std::uint32_t>();
  return header;
}

std::optional<FieldType> type_of(std::uint8_t datatype) {
  constexpr std::array types = {FieldType::int8,    FieldType::uint8,  FieldType::int16,
                                FieldType::uint16,  FieldType::int32,  FieldType::uint32,
                                FieldType::float32, FieldType::float64};
  if (datatype < 1 || datatype > types.size()) return std::nullopt;
  return types[datatype - 1U];
}

void read_fields(MessageReader& reader, PointLayout& layout, std::vector<std::size_t>& ends,
                 const std::string& where) {
  const auto count = reader.number<std::uint32_t>();
  if (reader.failed() || count > kMostFields) {
    throw InputError(where + ": announces " + std::to_string(count) +
                     " fields; the message is cut off or no PointCloud2");
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    PointField field;
    field.name = reader.text();
    field.offset = reader.number<std::uint32_t>();
    const auto datatype = reader.number<std::uint8_t>();
    (void)reader.number<std::uint32_t>();  // values a field; the first one is read
    const auto type = type_of(datatype);
    if (reader.failed()) throw InputError(where + ": is cut off within its fields");
    if (!type) {
      throw InputError(where + ": field '" + field.name.substr(0, 40) + "' has datatype " +
                       std::to_string(datatype) + "; PointCloud2 knows 1 to 8");
    }
    field.type = *type;
    ends.push_back(field.offset + size_of(field.type));
    layout.fields.push_back(std::move(field));
  }
}

// Puts rows together where they are padded.
void remove_row_padding(Cloud& cloud, std::size_t row, std::size_t row_step) {
  cloud.storage.resize(row * cloud.header.height);
  for (std::size_t r = 0; r < cloud.header.height; ++r) {
    const auto from = cloud.data.subspan(r * row_step, row);
    std::copy(from.begin(), from.end(),
              cloud.storage.begin() + static_cast<std::ptrdiff_t>(r * row));
  }
  cloud.data = cloud.storage;
}

}  // namespace

std::optional<CloudHeader> parse_cloud_header(std::span<const std::byte> message,
                                              Encoding encoding) {
  MessageReader reader(message, encoding);
  CloudHeader header = read_header(reader);
  if (reader.failed()) return std::nullopt;
  return header;
}

Cloud parse_cloud(std::span<const std::byte> message, Encoding encoding, const std::string& where) {
  MessageReader reader(message, encoding);
  Cloud cloud;
  cloud.header = read_header(reader);
  if (reader.failed()) {
    throw InputError(where + ": " + std::to_string(message.size()) +
                     " bytes are too few for a PointCloud2");
  }
  std::vector<std::size_t> ends;
  read_fields(reader, cloud.table.layout, ends, where);
  cloud.table.layout.big_endian = reader.number<std::uint8_t>() != 0;
  const std::uint64_t step = reader.number<std::uint32_t>();
  const std::uint64_t row_step = reader.number<std::uint32_t>();
  cloud.data = reader.blob();
  if (reader.failed()) {
    throw InputError(where + ": is cut off within its points; " + std::to_string(message.size()) +
                     " bytes are there");
  }
  const std::uint64_t width = cloud.header.width, height = cloud.header.height;
  // 32-bit factors: two of them cannot overflow, the third is held against the data first.
  const std::uint64_t row = width * step;
  // Rows of no points hold nothing, however many there are said to be.
  const bool padded = height > 1 && width > 0 && row_step > row;
  const std::uint64_t stride = padded ? row_step : row;
  const bool fits =
      height == 0 || width == 0 ||
      (step > 0 && row <= cloud.data.size() && height <= (cloud.data.size() - row) / stride + 1);
  if (!fits) {
    throw InputError(where + ": " + std::to_string(width) + " x " + std::to_string(height) +
                     " points of " + std::to_string(step) + " bytes do not fit its " +
                     std::to_string(cloud.data.size()) + " bytes of data");
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i] <= step) continue;
    throw InputError(where + ": field '" + cloud.table.layout.fields[i].name.substr(0, 40) +
                     "' ends at byte " + std::to_string(ends[i]) + " of a point of " +
                     std::to_string(step) + " bytes");
  }
  if (padded) remove_row_padding(cloud, row, row_step);
  for (PointField& field : cloud.table.layout.fields) field.stride = step;
  cloud.table.count = width * height;
  return cloud;
}

}  // namespace groundloop::recordings
