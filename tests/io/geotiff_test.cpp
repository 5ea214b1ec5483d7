#include "underbrush/io/geotiff.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

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

using Counts = std::map<std::string, size_t>;

Raster read(const fs::path& file) {
  Counts left_out;
  return read_geotiff(file, left_out);
}

std::string reason_of(const fs::path& file) {
  try {
    read(file);
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
    const Raster map = read(entry.path());
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
  const Raster map = read(kFolder / "lzw_long.tif");
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

// The bytes of a map of 4 × 2 cells of 1.5 m height, the first of which has the value `first`.
std::string map_of(float first, const std::string& no_data, const std::vector<uint16_t>& keys,
                   double cell = 2, double height = 1.5) {
  std::string data, entries;
  const auto add = [](std::string& to, auto value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  uint16_t count = 0;
  const auto entry = [&](uint16_t tag, uint16_t type, uint32_t n, std::string bytes) {
    ++count;
    add(entries, tag);
    add(entries, type);
    add(entries, n);
    if (bytes.size() > 4) {
      add(entries, uint32_t(8 + data.size()));
      data += bytes;
    } else {
      bytes.resize(4, '\0');
      entries += bytes;
    }
  };
  const auto number = [&](uint16_t tag, uint32_t value) {
    std::string bytes;
    add(bytes, value);
    entry(tag, 4, 1, bytes);
  };
  for (int k = 0; k < 8; ++k) add(data, k == 0 ? first : float(k * height));
  for (const auto& [tag, value] :
       {std::pair{256, 4}, {257, 2}, {258, 32}, {273, 8}, {278, 2}, {279, 32}, {339, 3}}) {
    number(uint16_t(tag), uint32_t(value));
  }
  std::string scale, tie, key;
  for (const double x : {cell, cell, 0.0}) add(scale, x);
  for (const double x : {0.0, 0.0, 0.0, 11.0, 48.0, 0.0}) add(tie, x);
  for (const uint16_t x : keys) add(key, x);
  entry(33550, 12, 3, scale);
  entry(33922, 12, 6, tie);
  if (!keys.empty()) entry(34735, 3, uint32_t(keys.size()), key);
  if (!no_data.empty()) entry(42113, 2, uint32_t(no_data.size() + 1), no_data + '\0');
  std::string out("II*\0", 4);
  add(out, uint32_t(8 + data.size()));
  out += data;
  add(out, count);
  return out + entries + std::string(4, '\0');
}

// Values for "no data" are written with 6 to 17 digits, or not at all; no cell is lost for it.
TEST(GeoTiff, CellsWithoutAHeightAreToldAndCounted) {
  const TemporaryFolder folder;
  constexpr float kLowest = -3.4028234663852886e38F;
  struct Case {
    float first;
    const char* no_data;
    bool named;
  };
  for (const Case& c :
       {Case{kLowest, "-3.4028234663852886e+38", true},
        Case{kLowest, "-3.40282346638529e+38", true}, Case{kLowest, "-3.4028235e+38", true},
        Case{kLowest, "-3.40282e+38", true}, Case{kLowest, "", false}, Case{-kLowest, "", false},
        Case{INFINITY, "", false}, Case{NAN, "", true}, Case{-9999, "", false},
        Case{-9999, "-9999", true}, Case{-9999, "-3.4028235e+38", false}, Case{-32768, "", false},
        Case{65535, "", false}, Case{kLowest, "-9999", false}, Case{0.1F, "0.1", true}}) {
    SCOPED_TRACE(std::to_string(c.first) + " and " + c.no_data);
    write_atomically(folder / "a.tif", map_of(c.first, c.no_data, {}));
    Counts left_out;
    const Raster map = read_geotiff(folder / "a.tif", left_out);
    EXPECT_TRUE(std::isnan(map.value[0]));
    for (size_t k = 1; k < 8; ++k) EXPECT_EQ(map.value[k], 1.5F * float(k));
    ASSERT_EQ(left_out.size(), 1u);
    EXPECT_EQ(left_out.begin()->second, 1u);
    EXPECT_EQ(left_out.begin()->first.find("does not name") == std::string::npos, c.named);
  }
  for (const float height : {0.0F, -432.0F, 8848.0F, 29029.0F}) {
    write_atomically(folder / "a.tif", map_of(height, "", {}));
    EXPECT_EQ(read(folder / "a.tif").value[0], height);
  }
}

TEST(GeoTiff, MapsInDegreesAreRefused) {
  const TemporaryFolder folder;
  const std::string degrees = "its map is in degrees; 'gdalwarp -t_srs EPSG:32632 IN.tif OUT.tif'";
  write_atomically(folder / "a.tif", map_of(1, "", {1, 1, 0, 1, 1024, 0, 1, 2}, 0.0003));
  EXPECT_THAT(reason_of(folder / "a.tif"), testing::HasSubstr(degrees));
  // Without a word about its system: heights vary by more than the width of the map.
  write_atomically(folder / "a.tif", map_of(1, "", {}, 0.0003));
  EXPECT_THAT(reason_of(folder / "a.tif"), testing::HasSubstr(degrees));
  write_atomically(folder / "a.tif", map_of(0, "", {}, 0.0003, 0.0001));  // A map of a table.
  EXPECT_EQ(reason_of(folder / "a.tif"), "");
  write_atomically(folder / "a.tif", map_of(1, "", {1, 1, 0, 1, 1024, 0, 1, 1}, 0.005));
  EXPECT_EQ(reason_of(folder / "a.tif"), "");
  write_atomically(folder / "a.tif",
                   map_of(1, "", {1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9003}, 6));
  EXPECT_NEAR(read(folder / "a.tif").unit_m, 0.3048, 1e-6);
}

TEST(GeoTiff, HeightsInAnotherUnitAreRefused) {
  const TemporaryFolder folder;
  const auto reason = [&](uint16_t map, uint16_t height) {
    write_atomically(folder / "a.tif",
                     map_of(1, "", {1, 1, 0, 2, 3076, 0, 1, map, 4099, 0, 1, height}, 6));
    return reason_of(folder / "a.tif");
  };
  EXPECT_THAT(reason(9001, 9002), testing::HasSubstr("different units, m and feet"));
  EXPECT_THAT(reason(9003, 9001), testing::HasSubstr("different units, m and feet"));
  for (const uint16_t unit : {9001, 9002, 9003}) EXPECT_EQ(reason(unit, unit), "");
  EXPECT_EQ(reason(9003, 9002), "") << "both are feet";
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
