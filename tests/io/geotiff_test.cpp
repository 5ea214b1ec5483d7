#include "underbrush/io/geotiff.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/tiff_piece.hpp"

namespace underbrush::io {
namespace {

namespace fs = std::filesystem;

// Files of GDAL, which geotiff/make.py made and describes.
const fs::path kFolder = UNDERBRUSH_GEOTIFF_FILES;

std::string reason_of(const fs::path& file) {
  try {
    read_geotiff(file);
  } catch (const FormatError& e) {
    return e.what();
  }
  return "";
}

TEST(GeoTiff, EveryCodingOfGdalHasTheSameHeights) {
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    const std::string name = entry.path().filename().string();
    if (name.find("strips") == std::string::npos && name.find("tiles") == std::string::npos) {
      continue;
    }
    SCOPED_TRACE(name);
    ++files;
    const Raster map = read_geotiff(entry.path());
    ASSERT_EQ(map.columns, 53u);
    ASSERT_EQ(map.rows, 37u);
    EXPECT_EQ(map.west, 412000);
    EXPECT_EQ(map.north, 5646000);
    EXPECT_EQ(map.cell_m, 2);
    for (uint32_t r = 0; r < map.rows; ++r) {
      for (uint32_t c = 0; c < map.columns; ++c) {
        const float z = map.value[r * map.columns + c];
        float expected = 100 + float(r) / 4 + float(c % 7) / 8;
        if (name.find("int16") != std::string::npos) expected = std::floor(expected);
        if (r == 3 && (c == 5 || c == 6)) {
          EXPECT_TRUE(std::isnan(z));
        } else {
          ASSERT_EQ(z, expected) << r << " " << c;
        }
      }
    }
  }
  EXPECT_EQ(files, 30u);
}

TEST(GeoTiff, ALongPieceFillsTheTableOfCodes) {
  const Raster map = read_geotiff(kFolder / "lzw_long.tif");
  ASSERT_EQ(map.value.size(), 96u * 96u);
  for (int r = 0; r < 96; ++r) {
    for (int c = 0; c < 96; ++c) {
      ASSERT_EQ(map.value[size_t(r * 96 + c)], float((r * 7919 + c * 104729) % 65521 - 32760));
    }
  }
}

TEST(GeoTiff, OtherCompressionsAreNamed) {
  EXPECT_THAT(reason_of(kFolder / "zstd.tif"),
              testing::HasSubstr("zstd.tif: is compressed by Zstandard; 'gdalwarp"));
}

// Bytes of a compressed file are changed, one after the other: the answer is a map or one line.
TEST(GeoTiff, DamagedFilesAreRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"lzw2_strips_float32_little.tif", "deflate3_tiles_float32_big.tif",
                           "packbits1_tiles_int16_little.tif"}) {
    const std::string good = read_file(kFolder / name);
    size_t refused = 0;
    for (size_t k = 0; k < good.size(); k += 11) {
      std::string bad = good;
      bad[k] = char(bad[k] ^ 0x55);
      write_atomically(folder / "bad.tif", bad);
      refused += !reason_of(folder / "bad.tif").empty();
    }
    EXPECT_GT(refused, 10u) << name;
    write_atomically(folder / "short.tif", good.substr(0, good.size() - good.size() / 4));
    EXPECT_THAT(reason_of(folder / "short.tif"), testing::HasSubstr("truncated")) << name;
  }
}

TEST(GeoTiff, TilesThatAreLargerThanTheMapAreRefused) {
  const TemporaryFolder folder;
  std::string bytes = read_file(kFolder / "deflate1_tiles_int16_little.tif");
  const std::string entry("\x42\x01\x03\x00\x01\x00\x00\x00\x10\x00\x00\x00", 12);  // Width 16.
  const size_t at = bytes.find(entry);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 12, std::string("\x42\x01\x04\x00\x01\x00\x00\x00\x00\x00\x00\x40", 12));
  write_atomically(folder / "wide.tif", bytes);
  EXPECT_THAT(reason_of(folder / "wide.tif"), testing::HasSubstr("tiles that are much larger"));
}

TEST(TiffPiece, ExamplesOfTheSpecification) {
  // PackBits: the example of TIFF 6.0, section 9.
  const std::string packed("\xFE\xAA\x02\x80\x00\x2A\xFD\xAA\x03\x80\x00\x2A\x22\xF7\xAA", 15);
  std::string plain("\xAA\xAA\xAA\x80\x00\x2A\xAA\xAA\xAA\xAA\x80\x00\x2A\x22", 14);
  plain += std::string(10, '\xAA');
  TiffCoding coding{32773, 1, 8, 24, false};
  EXPECT_EQ(decode_tiff_piece(packed, coding, 24), plain);
  EXPECT_FALSE(decode_tiff_piece(packed, coding, 25));
  // LZW: codes 256 7 258 8 8 258 6 6 257 of section 13, 9 bits each, are 7 7 7 8 8 7 7 6 6.
  std::string codes;
  uint64_t bits = 0, held = 0;
  for (const int code : {256, 7, 258, 8, 8, 258, 6, 6, 257}) {
    bits = bits << 9 | uint64_t(code);
    for (held += 9; held >= 8; held -= 8) codes.push_back(char(bits >> (held - 8)));
  }
  codes.push_back(char(bits << (8 - held)));
  coding = {5, 1, 8, 9, false};
  EXPECT_EQ(decode_tiff_piece(codes, coding, 9), "\7\7\7\10\10\7\7\6\6");
  EXPECT_FALSE(decode_tiff_piece(codes.substr(0, 5), coding, 9));
  EXPECT_FALSE(decode_tiff_piece(std::string(20, '\xFF'), coding, 9));  // No such code.
}

}  // namespace
}  // namespace underbrush::io
