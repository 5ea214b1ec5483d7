/// \file
/// Pictures.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace underbrush::io {

/// An RGB image, 8 bits a channel, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;  ///< 3·width·height.

  Image() = default;
  Image(int w, int h, uint8_t grey = 255) : width(w), height(h), rgb(size_t(3) * w * h, grey) {}
};

/// PNG bytes of the image.
std::vector<uint8_t> png_from_image(const Image& image);
/// Writes a PNG file, atomically.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace underbrush::io
