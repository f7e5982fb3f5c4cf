#include "apps/report/grey_picture.hpp"

#include <new>

#include <png.h>

namespace groundloop::apps {

std::vector<std::byte> to_png(const GreyPicture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_GRAY;
  std::vector<std::byte> png(PNG_IMAGE_PNG_SIZE_MAX(image));
  png_alloc_size_t bytes = png.size();
  const int written =
      png_image_write_to_memory(&image, png.data(), &bytes, 0, picture.pixels.data(), 0, nullptr);
  // To memory, of pixels that are there, nothing else can fail.
  if (written == 0) throw std::bad_alloc();
  png.resize(bytes);
  return png;
}

}  // namespace groundloop::apps
