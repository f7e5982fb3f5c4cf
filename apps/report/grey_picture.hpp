// A grey picture and its PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace groundloop::apps {

struct GreyPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< row by row from the top
};

/// The picture as PNG, 8 bits grey.
[[nodiscard]] std::vector<std::byte> to_png(const GreyPicture& picture);

}  // namespace groundloop::apps
