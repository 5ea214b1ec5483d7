/// \file
/// This file finds real data for tests: in the folder of the environment variable UNDERBRUSH_DATA,
/// else in shared/data beside the repository. Tests that need it are skipped where it is absent.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#ifdef UNDERBRUSH_TEST_LZMA
#include <lzma.h>
#endif

namespace underbrush::test {

inline std::filesystem::path data_folder() {
  const char* given = std::getenv("UNDERBRUSH_DATA");
  return given && *given ? std::filesystem::path(given)
                         : std::filesystem::path(UNDERBRUSH_TEST_DATA);
}

/// Skips the test with one line if `name` is not in the data folder.
#define UNDERBRUSH_NEEDS_DATA(name)                                         \
  if (!std::filesystem::exists(::underbrush::test::data_folder() / (name))) \
  GTEST_SKIP() << "real data '" << (name) << "' absent: set UNDERBRUSH_DATA"

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

#ifdef UNDERBRUSH_TEST_LZMA
/// Reads frame `index` of a `velodyne.kfx` archive, whose format is that of frames.py in the data
/// folder. It gives x y z intensity of each point, or nothing if there is no such frame.
inline std::vector<float> kitti_frame(const std::string& drive, uint32_t index) {
  std::ifstream in(data_folder() / drive / "velodyne.kfx", std::ios::binary);
  in.seekg(4);
  struct {
    uint32_t index, n;
    uint64_t size;
  } head;
  while (in.read(reinterpret_cast<char*>(&head), sizeof head)) {
    if (head.index != index) {
      in.seekg(std::streamoff(head.size), std::ios::cur);
      continue;
    }
    const size_t n = head.n;
    std::vector<uint8_t> packed(head.size), raw(16 * n + 1);
    in.read(reinterpret_cast<char*>(packed.data()), std::streamsize(head.size));
    uint64_t memory = UINT64_MAX;
    size_t in_at = 0, out_at = 0;
    if (lzma_stream_buffer_decode(&memory, 0, nullptr, packed.data(), &in_at, packed.size(),
                                  raw.data(), &out_at, raw.size()) != LZMA_OK) {
      return {};
    }
    std::vector<float> out(4 * n);
    if (raw[0] == 'R') {
      std::memcpy(out.data(), raw.data() + 1, 16 * n);
      return out;
    }
    // The data are planes of bytes: for each axis and each byte of the little-endian difference in
    // mm, one byte a point. The planes of the intensity follow.
    const auto word = [&](size_t plane, size_t i) {
      uint32_t v = 0;
      for (size_t b = 0; b < 4; ++b) v |= uint32_t(raw[1 + (plane * 4 + b) * n + i]) << (8 * b);
      return v;
    };
    int64_t mm[3] = {0, 0, 0};
    for (size_t i = 0; i < n; ++i) {
      for (size_t axis = 0; axis < 3; ++axis) {
        mm[axis] += int32_t(word(axis, i));
        out[4 * i + axis] = float(double(mm[axis]) / 1000);
      }
      const uint32_t bits = word(3, i);
      std::memcpy(&out[4 * i + 3], &bits, 4);
    }
    return out;
  }
  return {};
}
#endif

}  // namespace underbrush::test
