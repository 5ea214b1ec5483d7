#include "underbrush/io/mesh_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace {

class MeshFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  TemporaryFolder folder;
};

TEST_F(MeshFile, ReadsTheSameSquareOfObjAndPly) {
  const MeshData obj = read_mesh(write("a.OBJ",
                                       "# a square\no one\nv 0 0 0\nv 1 0 0 1.0\nvt 0 0\nvn 0 0 1\n"
                                       "v 1 1 0.5\r\nv 0 1 +0.5\ng leaves\nusemtl x\n"
                                       "f 1/1/1 -3//1 3/1 4\n"));
  const MeshData ply = read_mesh(write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty "
      "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
      "0\n1 1 0.5\n0 1 0.5\n4 0 1 2 3\n"));
  for (const MeshData& m : {obj, ply}) {
    ASSERT_EQ(m.vertices.size(), 4u);
    EXPECT_EQ(m.vertices[2], Vec3f(1, 1, 0.5f));
    ASSERT_EQ(m.triangles.size(), 2u);
    EXPECT_EQ(m.triangles[0], (std::array<uint32_t, 3>{0, 1, 2}));
    EXPECT_EQ(m.triangles[1], (std::array<uint32_t, 3>{0, 2, 3}));
  }
}

TEST_F(MeshFile, CoordinatesThatAreNoNumbersAreRefused) {
  for (size_t c = 0; c < 9; ++c) {
    std::array<float, 12> facet{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    facet[3 + c] = NAN;
    std::string stl = std::string(80, ' ') + std::string("\1\0\0\0", 4);
    stl.append(reinterpret_cast<const char*>(facet.data()), sizeof facet);
    EXPECT_THROW(read_mesh(write("a.stl", stl + std::string(2, '\0'))), FormatError) << c;
    std::string ply =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty "
        "float y\nproperty float z\nelement face 1\nproperty list uchar uchar "
        "vertex_indices\nend_header\n";
    ply.append(reinterpret_cast<const char*>(&facet[3]), 9 * sizeof(float));
    EXPECT_THROW(read_mesh(write("a.ply", ply + std::string("\3\0\1\2", 4))), FormatError) << c;
  }
}

TEST_F(MeshFile, LinesOfObjGoOnBehindABackslash) {
  const MeshData m = read_mesh(write(
      "a.obj", "# C:\\models\\\nv 0 0 0\nv 1 0 \\\r\n0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 \\\n4\n"));
  EXPECT_EQ(m.vertices.size(), 4u);
  EXPECT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(read_mesh(write("b.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3 \\")).triangles.size(),
            1u);
}

TEST_F(MeshFile, StripsOfPlyAreNamed) {
  const auto file = write("a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
                          "float y\nproperty float z\nelement tristrips 1\nproperty list int int "
                          "vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n5 0 1 2 -1 0\n");
  try {
    read_mesh(file);
    ADD_FAILURE();
  } catch (const FormatError& e) {
    EXPECT_NE(std::string(e.what()).find("tristrips"), std::string::npos) << e.what();
  }
}

TEST_F(MeshFile, NamesThePlaceOfWhatIsWrong) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const auto& [text, place] : {std::pair<std::string, std::string>{v + "f 1 2 4\n", "line 4"},
                                    {v + "f 0 1 2\n", "line 4"},
                                    {v + "f -4 1 2\n", "line 4"},
                                    {v + "f 1 2\n", "line 4"},
                                    {v + "f 1 2 x\n", "line 4"},
                                    {v + "f 1.5 2 3\n", "line 4"},
                                    {"v 0 nan 0\n", "line 1"},
                                    {"v 0 0\n", "line 1"},
                                    {v, "no triangles"},
                                    {"", "no triangles"}}) {
    try {
      read_mesh(write("bad.obj", text));
      ADD_FAILURE() << text;
    } catch (const FormatError& e) {
      EXPECT_NE(std::string(e.what()).find(place), std::string::npos) << e.what();
    }
  }
  EXPECT_THROW(read_mesh(write("a.fbx", v)), FormatError);
  EXPECT_THROW(read_mesh(folder / "none.obj"), FormatError);
}

}  // namespace
}  // namespace underbrush::io
