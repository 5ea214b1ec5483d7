#include "underbrush/io/gltf_mesh.hpp"

#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/mesh_file.hpp"

namespace underbrush::io {
namespace {

std::string base64(const std::string& bytes) {
  static const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t k = 0; k < bytes.size(); k += 3) {
    uint32_t word = 0;
    for (size_t i = 0; i < 3; ++i) {
      word = word << 8 | (k + i < bytes.size() ? uint8_t(bytes[k + i]) : 0);
    }
    for (size_t i = 0; i < 4; ++i) {
      out += k + i <= bytes.size() ? kDigits[word >> (18 - 6 * i) & 63] : '=';
    }
  }
  return out;
}

/// Makes the buffer of a square: four corners in 48 bytes of floats, and two triangles in 12 bytes
/// of indices.
std::string square(float side = 1) {
  std::string bytes;
  for (const float x : {0.f, 0.f, 0.f, side, 0.f, 0.f, side, side, 0.f, 0.f, side, 0.f}) {
    add(bytes, x);
  }
  for (const uint16_t i : {0, 1, 2, 0, 2, 3}) add(bytes, i);
  return bytes;
}

/// Makes a glTF of a buffer; `nodes`, `mesh` and `more` are JSON.
std::string gltf(const std::string& buffer, const std::string& nodes,
                 const std::string& primitive = R"({"attributes":{"POSITION":0},"indices":1})",
                 const std::string& accessors = "", size_t bytes = 60) {
  const std::string usual =
      R"([{"bufferView":0,"componentType":5126,"type":"VEC3","count":4,"min":[0,0,0],"max":[9,9,9]},
          {"bufferView":1,"componentType":5123,"type":"SCALAR","count":6}])";
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[)" + primitive + R"(]}],"accessors":)" +
         (accessors.empty() ? usual : accessors) +
         R"(,"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},
             {"buffer":0,"byteOffset":48,"byteLength":12}],"buffers":[{)" +
         buffer + R"("byteLength":)" + std::to_string(bytes) + "}]}";
}

std::string inlined(const std::string& bytes) {
  return R"("uri":"data:application/octet-stream;base64,)" + base64(bytes) + "\",";
}

std::string glb(std::string json, const std::string& bytes) {
  while (json.size() % 4) json += ' ';
  std::string out = "glTF";
  add(out, uint32_t(2));
  add(out, uint32_t(12 + 8 + json.size() + 8 + bytes.size()));
  add(out, uint32_t(json.size()));
  out += "JSON" + json;
  add(out, uint32_t(bytes.size()));
  out += std::string("BIN\0", 4) + bytes;
  return out;
}

class Gltf : public testing::Test {
 protected:
  MeshData read(const std::string& name, const std::string& text) {
    put_bytes(folder / name, text);
    return read_mesh(folder / name);
  }
  TemporaryFolder folder;
};

TEST_F(Gltf, TextBinaryAndBufferFileGiveTheSameMesh) {
  const std::string node = R"([{"mesh":0}])";
  put_bytes(folder / "leaf.bin", square());
  for (const MeshData& m : {read("a.gltf", gltf(inlined(square()), node)),
                            read("b.gltf", gltf(R"("uri":"leaf.bin",)", node)),
                            read("c.GLB", glb(gltf("", node), square()))}) {
    ASSERT_EQ(m.vertices.size(), 4u);
    EXPECT_EQ(m.vertices[2], Vec3f(1, 1, 0));
    ASSERT_EQ(m.triangles.size(), 2u);
    EXPECT_EQ(m.triangles[1], (std::array<uint32_t, 3>{0, 2, 3}));
  }
}

TEST_F(Gltf, NodesMoveTheirMeshes) {
  const MeshData m = read("a.gltf", gltf(inlined(square()), R"([
      {"children":[1,2],"translation":[10,0,0],"scale":[2,2,2]},
      {"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476]},
      {"mesh":0,"matrix":[1,0,0,0, 0,0,1,0, 0,-1,0,0, 0,5,0,1]}])"));
  ASSERT_EQ(m.vertices.size(), 8u);
  EXPECT_LT((m.vertices[1] - Vec3f(10, 2, 0)).norm(), 1e-5f);   // x, rotated to y
  EXPECT_LT((m.vertices[3] - Vec3f(8, 0, 0)).norm(), 1e-5f);    // y, rotated to −x
  EXPECT_LT((m.vertices[7] - Vec3f(10, 10, 2)).norm(), 1e-5f);  // y, rotated to z, and moved
  EXPECT_EQ(m.triangles[3], (std::array<uint32_t, 3>{4, 6, 7}));
}

TEST_F(Gltf, StripsFansAndLists) {
  const auto count = [&](const std::string& primitive) {
    return read("a.gltf", gltf(inlined(square()), R"([{"mesh":0}])", primitive)).triangles;
  };
  using T = std::vector<std::array<uint32_t, 3>>;
  EXPECT_EQ(count(R"({"attributes":{"POSITION":0},"mode":5})"), (T{{0, 1, 2}, {1, 2, 3}}));
  EXPECT_EQ(count(R"({"attributes":{"POSITION":0},"mode":6})"), (T{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(count(R"({"attributes":{"POSITION":0}})"), (T{{0, 1, 2}}));
  EXPECT_THROW(count(R"({"attributes":{"POSITION":0},"mode":1})"), FormatError);  // lines alone
}

TEST_F(Gltf, WhatIsWrongIsRefused) {
  const std::string node = R"([{"mesh":0}])", good = gltf(inlined(square()), node);
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  for (const std::string& text :
       {std::string(),
        std::string("{}"),
        std::string("[1]"),
        std::string("glTF"),
        replaced(R"("count":4)", R"("count":5)"),
        replaced(R"("count":6)", R"("count":7)"),
        replaced(R"("count":4)", R"("count":3)"),
        replaced("5126", "5123"),
        replaced("5123", "5126"),
        replaced(R"("nodes":[0])", R"("nodes":[4])"),
        replaced(R"([{"mesh":0}])", R"([{"mesh":3}])"),
        replaced(R"([{"mesh":0}])", R"([{"children":[0]}])"),
        replaced(R"("bufferView":1)", R"("bufferView":9)"),
        replaced(R"("byteOffset":48)", R"("byteOffset":49)"),
        replaced(R"("byteLength":60)", R"("byteLength":600)"),
        replaced(R"("indices":1)", R"("indices":7)"),
        replaced(R"({"mesh":0})", R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}})"),
        gltf(R"("uri":"none.bin",)", node),
        gltf(R"("uri":"../outside.bin",)", node),
        gltf(R"("uri":"/etc/passwd",)", node),
        gltf(inlined(square(INFINITY)), node)}) {
    EXPECT_THROW(read("bad.gltf", text), FormatError) << text;
  }
}

// Every byte is changed and the file is cut at every place; it must be refused or read.
TEST_F(Gltf, DamageIsRefusedOrHarmless) {
  const std::string whole = glb(gltf("", R"([{"mesh":0}])"), square());
  size_t refused = 0;
  for (size_t k = 0; k < whole.size(); k += 3) {
    for (const char c : {'\0', '9', '\xff'}) {
      std::string bad = whole;
      bad[k] = c;
      try {
        read("bad.glb", bad);
      } catch (const FormatError&) {
        ++refused;
      }
    }
    EXPECT_THROW(read("cut.glb", whole.substr(0, k)), FormatError) << k;
  }
  EXPECT_GT(refused, whole.size() / 4);
}

}  // namespace
}  // namespace underbrush::io
