#include "apps/report/blobs.hpp"

#include <algorithm>
#include <bit>
#include <new>

#include <zlib.h>

#include "frontend/core/error.hpp"

namespace groundloop::apps {

static_assert(std::endian::native == std::endian::little, "arrays go into the page as they lie");

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = (group << 8) | (k < n ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= n ? kAlphabet[(group >> (18 - 6 * k)) & 63U] : '=';
  }
  return text;
}

std::vector<std::byte> deflate_bytes(std::span<const std::byte> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::byte> packed(size);
  const int result = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()),
                               static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION);
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  check(result == Z_OK, "an array in memory can be deflated");
  packed.resize(size);
  return packed;
}

std::vector<std::byte> shuffle_bytes(std::span<const std::byte> bytes, std::size_t width) {
  std::vector<std::byte> planes;
  planes.reserve(bytes.size());
  for (std::size_t k = 0; k < width; ++k) {
    for (std::size_t i = k; i < bytes.size(); i += width) planes.push_back(bytes[i]);
  }
  return planes;
}

nlohmann::ordered_json Blobs::add_bytes(std::span<const std::byte> bytes, std::size_t width,
                                        const char* type) {
  texts_.push_back(base64(deflate_bytes(shuffle_bytes(bytes, width))));
  bytes_ += texts_.back().size();
  return {{"blob", texts_.size() - 1}, {"type", type}, {"length", bytes.size() / width}};
}

nlohmann::ordered_json Blobs::add(std::span<const float> values) {
  return add_bytes(std::as_bytes(values), sizeof(float), "f32");
}
nlohmann::ordered_json Blobs::add(std::span<const double> values) {
  return add_bytes(std::as_bytes(values), sizeof(double), "f64");
}
nlohmann::ordered_json Blobs::add(std::span<const std::uint32_t> values) {
  return add_bytes(std::as_bytes(values), sizeof(std::uint32_t), "u32");
}
nlohmann::ordered_json Blobs::add(std::span<const std::uint16_t> values) {
  return add_bytes(std::as_bytes(values), sizeof(std::uint16_t), "u16");
}
nlohmann::ordered_json Blobs::add(std::span<const std::uint8_t> values) {
  return add_bytes(std::as_bytes(values), sizeof(std::uint8_t), "u8");
}

std::string Blobs::html() {
  std::string html;
  for (; given_ < texts_.size(); ++given_) {
    html += "<script type=\"text/plain\" id=\"blob-" + std::to_string(given_) + "\">" +
            texts_[given_] + "</script>\n";
    texts_[given_].clear();
    texts_[given_].shrink_to_fit();
  }
  return html;
}

}  // namespace groundloop::apps
