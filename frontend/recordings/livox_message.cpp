#include "frontend/recordings/livox_message.hpp"

#include "frontend/core/error.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::size_t kPoint = 19;  // offset_time, x, y, z, reflectivity, tag, line

CloudHeader read_header(MessageReader& reader) {
  CloudHeader header;
  static_cast<MessageHeader&>(header) = reader.header();
  (void)reader.number<std::uint64_t>();  // time base
  header.height = 1;
  header.width = reader.number<std::uint32_t>();
  (void)reader.bytes(4);  // number of the sensor, reserved
  return header;
}

PointLayout livox_layout(std::size_t stride) {
  PointLayout layout;
  layout.append("offset_time", FieldType::uint32);
  for (const char* name : {"x", "y", "z"}) layout.append(name, FieldType::float32);
  for (const char* name : {"reflectivity", "tag", "line"}) layout.append(name, FieldType::uint8);
  for (PointField& field : layout.fields) field.stride = stride;
  return layout;
}

}  // namespace

bool is_livox_message(const std::string& type) {
  for (const char* package : {"livox_ros_driver", "livox_ros_driver2", "livox_interfaces"}) {
    const std::string name = package;
    if (type == name + "/CustomMsg" || type == name + "/msg/CustomMsg") return true;
  }
  return false;
}

std::optional<CloudHeader> parse_livox_header(std::span<const std::byte> message,
                                              Encoding encoding) {
  MessageReader reader(message, encoding);
  CloudHeader header = read_header(reader);
  if (reader.failed()) return std::nullopt;
  return header;
}

Cloud parse_livox(std::span<const std::byte> message, Encoding encoding, const std::string& where) {
  MessageReader reader(message, encoding);
  Cloud cloud;
  cloud.header = read_header(reader);
  const std::size_t count = reader.number<std::uint32_t>();
  // CDR aligns each point's first number, behind the last there is nothing.
  const std::size_t stride = encoding == Encoding::cdr ? kPoint + 1 : kPoint;
  cloud.data = reader.bytes(count == 0 ? 0 : (count - 1) * stride + kPoint);
  if (reader.failed()) {
    throw InputError(where + ": " + std::to_string(message.size()) +
                     " bytes are too few for a Livox CustomMsg of " + std::to_string(count) +
                     " points; it is cut off");
  }
  cloud.table.layout = livox_layout(stride);
  cloud.table.count = count;
  return cloud;
}

}  // namespace groundloop::recordings
