#include "underbrush/io/image.hpp"

#include <png.h>

#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::io {

std::vector<uint8_t> png_from_image(const Image& image) {
  require(image.width > 0 && image.height > 0 &&
              image.rgb.size() == size_t(3) * size_t(image.width) * size_t(image.height),
          "image: size and pixels disagree");
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = uint32_t(image.width);
  png.height = uint32_t(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (!png_image_write_to_memory(&png, nullptr, &size, 0, image.rgb.data(), 0, nullptr)) {
    throw std::runtime_error(std::string("png: ") + png.message);
  }
  std::vector<uint8_t> bytes(size);
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) {
    throw std::runtime_error(std::string("png: ") + png.message);
  }
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  const std::vector<uint8_t> bytes = png_from_image(image);
  write_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace underbrush::io
