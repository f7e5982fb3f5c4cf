// sensor_msgs/PointCloud2 messages built byte by byte, as ROS 1 and CDR serialise them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/bytes.hpp"

namespace groundloop::testing {

/// Two points (1 2 3) and (-4.5 0.25 6) with float32 x y z and uint32 t (ns: 0, 90 000 000).
struct CloudSpec {
  std::uint32_t seconds = 0, nanoseconds = 0;
  std::uint32_t height = 1, width = 2, point_step = 16, row_step = 32;
  bool big_endian_points = false;
  std::string third_field = "z";
  std::uint8_t datatype = 7;
  std::string data;  ///< filled in if empty
};

inline std::string points_of(const CloudSpec& spec) {
  if (!spec.data.empty()) return spec.data;
  Bytes data;
  const auto point = [&](float x, float y, float z, std::uint32_t t) {
    if (spec.big_endian_points) {
      data.put_big(x).put_big(y).put_big(z).put_big(t);
    } else {
      data.put(x).put(y).put(z).put(t);
    }
  };
  point(1, 2, 3, 0);
  point(-4.5F, 0.25F, 6, 90'000'000);
  return data.str();
}

inline std::string ros1_cloud(const CloudSpec& spec) {
  Bytes m;
  m.put<std::uint32_t>(17).put(spec.seconds).put(spec.nanoseconds);
  m.counted<std::uint32_t>("os_sensor").put(spec.height).put(spec.width).put<std::uint32_t>(4);
  std::uint32_t offset = 0;
  for (const std::string& name : {std::string("x"), std::string("y"), spec.third_field}) {
    m.counted<std::uint32_t>(name).put(offset).put(spec.datatype).put<std::uint32_t>(1);
    offset += 4;
  }
  m.counted<std::uint32_t>("t").put<std::uint32_t>(12).put<std::uint8_t>(6).put<std::uint32_t>(1);
  m.put<std::uint8_t>(spec.big_endian_points ? 1 : 0).put(spec.point_step).put(spec.row_step);
  m.counted<std::uint32_t>(points_of(spec)).put<std::uint8_t>(1);
  return m.str();
}

/// CDR of either endianness: numbers aligned to their size from behind the four bytes of
/// encapsulation, strings with a zero at their end.
inline std::string cdr_cloud(const CloudSpec& spec, bool big = false) {
  Bytes body;
  const auto number = [&](auto value) {
    while (body.size() % sizeof(value) != 0) body.put<std::uint8_t>(0);
    big ? body.put_big(value) : body.put(value);
  };
  const auto text = [&](const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    body.text(value).put<std::uint8_t>(0);
  };
  number(static_cast<std::int32_t>(spec.seconds));
  number(spec.nanoseconds);
  text("os_sensor");
  number(spec.height);
  number(spec.width);
  number(std::uint32_t{4});
  std::uint32_t offset = 0;
  for (const std::string& name : {std::string("x"), std::string("y"), spec.third_field}) {
    text(name);
    number(offset);
    number(spec.datatype);
    number(std::uint32_t{1});
    offset += 4;
  }
  text("t");
  number(std::uint32_t{12});
  number(std::uint8_t{6});
  number(std::uint32_t{1});
  number(static_cast<std::uint8_t>(spec.big_endian_points ? 1 : 0));
  number(spec.point_step);
  number(spec.row_step);
  const std::string points = points_of(spec);
  number(static_cast<std::uint32_t>(points.size()));
  body.text(points).put<std::uint8_t>(1);
  Bytes message;
  message.put<std::uint8_t>(0).put<std::uint8_t>(big ? 0 : 1).put<std::uint16_t>(0);
  return message.text(body.str()).str();
}

}  // namespace groundloop::testing
