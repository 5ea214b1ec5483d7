#include "underbrush/io/raster_file.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "io/temporary.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::io {
namespace {

template <class T>
T at(const std::string& bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// The bytes of every tag, read by the rules of TIFF 6.0 alone.
std::map<int, std::string> tags_of(const std::string& bytes) {
  std::map<int, std::string> tags;
  const auto directory = at<uint32_t>(bytes, 4);
  const auto n = at<uint16_t>(bytes, directory);
  int last = 0;
  for (size_t k = 0; k < n; ++k) {
    const size_t entry = directory + 2 + 12 * k;
    const int tag = at<uint16_t>(bytes, entry), type = at<uint16_t>(bytes, entry + 2);
    EXPECT_GT(tag, last);  // They must rise.
    last = tag;
    const size_t size = size_t(type == 2    ? 1
                               : type == 3  ? 2
                               : type == 12 ? 8
                                            : 4) *
                        at<uint32_t>(bytes, entry + 4);
    tags[tag] = bytes.substr(size <= 4 ? entry + 8 : at<uint32_t>(bytes, entry + 8), size);
    EXPECT_EQ(tags[tag].size(), size);
  }
  EXPECT_EQ(at<uint32_t>(bytes, directory + 2 + 12 * n), 0u);
  EXPECT_EQ(bytes.size(), directory + 2 + 12 * size_t(n) + 4);
  return tags;
}

TEST(RasterFile, AGeoTiffHasItsValuesAndItsPlace) {
  const TemporaryFolder folder;
  Raster r{3, 2, {1, 2, 3, 4, NAN, 6.5F}, 500000, 4500020, 0.5, 25832};
  write_geotiff(folder / "a.tif", r);
  const std::string bytes = read_file(folder / "a.tif");
  EXPECT_EQ(bytes.substr(0, 4), std::string("II*\0", 4));
  auto tags = tags_of(bytes);
  EXPECT_EQ(at<uint32_t>(tags[256], 0), 3u);
  EXPECT_EQ(at<uint32_t>(tags[257], 0), 2u);
  EXPECT_EQ(at<uint16_t>(tags[258], 0), 32);
  EXPECT_EQ(at<uint16_t>(tags[339], 0), 3);
  const auto strip = at<uint32_t>(tags[273], 0);
  EXPECT_EQ(at<uint32_t>(tags[279], 0), 24u);
  EXPECT_EQ(at<float>(bytes, strip), 1);
  EXPECT_EQ(at<float>(bytes, strip + 20), 6.5F);
  EXPECT_EQ(at<double>(tags[33550], 8), 0.5);
  EXPECT_EQ(at<double>(tags[33922], 24), 500000);
  EXPECT_EQ(at<double>(tags[33922], 32), 4500020);
  EXPECT_EQ(tags[34735].size(), 2 * 4 * 4u);
  EXPECT_EQ(at<uint16_t>(tags[34735], 2 * 15), 25832);
  EXPECT_STREQ(tags[42113].c_str(), "nan");
  r.epsg = 0;
  write_geotiff(folder / "b.tif", r);
  EXPECT_EQ(tags_of(read_file(folder / "b.tif"))[34735].size(), 2 * 4 * 2u);
  r.value.pop_back();
  EXPECT_THROW(write_geotiff(folder / "c.tif", r), std::invalid_argument);
}

TEST(RasterFile, AnArrayIsNpy) {
  const TemporaryFolder folder;
  write_npy(folder / "a.npy", {2, 1, 3}, {1, 2, 3, 4, 5, 6});
  const std::string bytes = read_file(folder / "a.npy");
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const size_t header = at<uint16_t>(bytes, 8);
  EXPECT_EQ((10 + header) % 64, 0u);
  EXPECT_EQ(bytes[9 + header], '\n');
  EXPECT_NE(bytes.find("'descr': '<f4', 'fortran_order': False, 'shape': (2, 1, 3, ), }"),
            std::string::npos);
  EXPECT_EQ(at<float>(bytes, 10 + header + 20), 6);
  EXPECT_THROW(write_npy(folder / "b.npy", {2, 2}, {1}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::io
