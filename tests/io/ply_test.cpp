#include "underbrush/io/ply.hpp"

#include <gtest/gtest.h>

#include "temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

PlyData sample() {
  PlyData data;
  data.comments = {"made by hand"};
  PlyElement vertex;
  vertex.name = "vertex";
  vertex.count = 4;
  vertex.columns = {{"x", std::vector<double>{0, 1, 1, 0.1}},
                    {"u8", std::vector<uint8_t>{0, 1, 2, 255}},
                    {"i16", std::vector<int16_t>{-1, 0, 1, -32768}},
                    {"u32", std::vector<uint32_t>{0, 1, 2, 4294967295u}},
                    {"f", std::vector<float>{0.1f, 0, -0.0f, 3e38f}}};
  PlyElement face;
  face.name = "face";
  face.count = 2;
  face.columns = {{"p", std::vector<float>{0.5f, 0.25f}}};
  face.triangles = {{0, 1, 2}, {0, 2, 3}};
  data.elements = {vertex, face};
  return data;
}

TEST(Ply, RoundTrip) {
  const TemporaryFolder folder;
  const PlyData data = sample();
  write_ply(folder / "a.ply", data);
  const PlyData back = read_ply(folder / "a.ply");
  EXPECT_EQ(back.comments, data.comments);
  ASSERT_EQ(back.elements.size(), 2u);
  for (size_t e = 0; e < 2; ++e) {
    EXPECT_EQ(back.elements[e].name, data.elements[e].name);
    EXPECT_EQ(back.elements[e].count, data.elements[e].count);
    EXPECT_EQ(back.elements[e].columns, data.elements[e].columns);
    EXPECT_EQ(back.elements[e].triangles, data.elements[e].triangles);
  }
}

TEST(Ply, ReadsTextAndSplitsPolygons) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.ply",
            "ply\r\nformat ascii 1.0\r\nobj_info x\r\ncomment hello there\r\nelement vertex 4\r\n"
            "property float x\r\nproperty int8 k\r\nelement face 1\r\n"
            "property list uchar int vertex_index\r\nproperty list uchar float uv\r\n"
            "property uint8 c\r\nend_header\r\n1.5 -1\r\n2e3 2\r\nnan 3\r\n+4 4\r\n"
            "4 0 1 2 3 2 0.5 0.5 9\r\n");
  const PlyData data = read_ply(folder / "a.ply");
  EXPECT_EQ(data.comments, (std::vector<std::string>{"hello there"}));
  EXPECT_EQ(std::get<std::vector<int8_t>>(*data.find("vertex")->find("k")),
            (std::vector<int8_t>{-1, 2, 3, 4}));
  EXPECT_EQ(std::get<std::vector<float>>(*data.find("vertex")->find("x"))[1], 2000);
  EXPECT_EQ(data.find("face")->triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(data.find("vertex")->find("absent"), nullptr);
  EXPECT_EQ(data.find("edge"), nullptr);
}

TEST(Ply, ReadsBigEndian) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.ply", std::string("ply\nformat binary_big_endian 1.0\nelement vertex 1\n"
                                          "property float x\nproperty ushort k\nend_header\n") +
                                  std::string("\x3f\x80\0\0\1\2", 6));
  const PlyData data = read_ply(folder / "a.ply");
  EXPECT_EQ(std::get<std::vector<float>>(*data.find("vertex")->find("x"))[0], 1);
  EXPECT_EQ(std::get<std::vector<uint16_t>>(*data.find("vertex")->find("k"))[0], 258);
}

TEST(Ply, RefusesDamage) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::string& bytes) {
    put_bytes(folder / "bad.ply", bytes);
    EXPECT_THROW(read_ply(folder / "bad.ply"), FormatError) << bytes.substr(0, 200);
  };
  write_ply(folder / "a.ply", sample());
  const std::string good = bytes_of(folder / "a.ply");
  for (size_t n = 0; n < good.size(); ++n) refuses(good.substr(0, n));
  refuses(good + "x");
  const std::string head = "ply\nformat ascii 1.0\nelement vertex ";
  refuses(head + "1\nproperty float x\nend_header\nabc\n");
  refuses(head + "1\nproperty uchar x\nend_header\n256\n");
  refuses(head + "-1\nproperty uchar x\nend_header\n");
  refuses(head + "99999999999\nproperty uchar x\nend_header\n1\n");
  refuses(head + "99999999999\nend_header\n1\n");
  refuses(head + "1\nproperty string x\nend_header\n1\n");
  refuses(head + "1\nproperty float x\nproperty float x\nend_header\n1 1\n");
  refuses("ply\nelement vertex 1\nproperty float x\nend_header\n1\n");
  refuses(head +
          "1\nproperty float x\nelement face 1\nproperty list uchar int vertex_indices\n"
          "end_header\n1\n3 0 0 1\n");
  refuses(head +
          "1\nproperty float x\nelement face 1\nproperty list int int vertex_indices\n"
          "end_header\n1\n-3 0 0 1\n");
}

}  // namespace
}  // namespace underbrush::io
