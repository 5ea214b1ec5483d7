/// \file
/// RGB images and PNG files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace underbrush::io {

/// An RGB image with 8 bits for each channel; rows are stored from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;  ///< Red, green, blue of each pixel; 3·width·height values.

  Image() = default;
  Image(int w, int h, uint8_t grey = 255) : width(w), height(h), rgb(size_t(3) * w * h, grey) {}
};

/// Encodes the image as PNG and returns the bytes.
std::vector<uint8_t> png_from_image(const Image& image);
/// Writes the image as a PNG file, atomically. Throws `IoError`.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace underbrush::io
