#include "studies/solid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/test_site/plant_mesh.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::studies {
namespace {

double area(const elements::TriangleMesh& mesh) {
  double sum = 0;
  for (size_t i = 0; i < mesh.size(); ++i) sum += test_site::triangle_area(mesh, i);
  return sum;
}

TEST(Solid, MiniatureIsThreeClosedCubes) {
  const Solid solid = miniature();
  solid.check();
  EXPECT_EQ(solid.faces.size(), 18u);
  EXPECT_NEAR(area(triangulated(solid).mesh), 6 + 2 * 6 * 0.04, 1e-6);
  // By Gauss's theorem, the volume follows from the outward faces.
  double volume = 0;
  const SolidMesh mesh = triangulated(solid);
  for (const auto& t : mesh.mesh.triangles) {
    const Vec3 a = solid.vertices[t[0]], b = solid.vertices[t[1]], c = solid.vertices[t[2]];
    volume += a.dot(b.cross(c)) / 6;
  }
  EXPECT_NEAR(volume, 1 + 2 * 0.008, 1e-12);
}

TEST(Solid, ThePatchesAreWhatAScannerOnTheDiagonalSees) {
  const Solid solid = miniature();
  const Vec3 eye(-17, -17, 5);
  for (const size_t face : miniature_patches()) {
    EXPECT_GT(solid.normal(face).dot(eye - solid.corners(face)[0]), 0) << face;
  }
  EXPECT_EQ(solid.normal(miniature_patches()[0]), Vec3::UnitZ());
  EXPECT_EQ(solid.normal(miniature_patches()[4]), -Vec3::UnitX());  // left as seen from (−1, −1)
  EXPECT_EQ(solid.normal(miniature_patches()[8]), -Vec3::UnitY());
}

TEST(Solid, APointOnAnEdgeIsOfBothFaces) {
  const Solid cube = block({0, 0, 0}, {1, 1, 1});
  const Vec3 edge(0.5, 0.2, 1), corner(0.5, 0.5, 1);
  for (const size_t face : {size_t(1), size_t(3)}) {
    EXPECT_TRUE(over_face(cube, face, edge));
    EXPECT_TRUE(over_face(cube, face, corner));
    EXPECT_FALSE(over_face(cube, face, edge, -0.01));
  }
  EXPECT_FALSE(over_face(cube, 1, {0.51, 0.2, 1}));
  EXPECT_TRUE(over_face(cube, 1, {0.51, 0.2, 1}, 0.011));
}

// A beam through an edge or a corner must not slip between the triangles.
TEST(Solid, BeamsThroughEdgesAndCornersHit) {
  elements::Model model;
  model.surface = triangulated(block({0, 0, 0}, {1, 1, 1})).mesh;
  const trace::World world(model);
  for (const Vec3& to :
       {Vec3(-0.5, -0.5, 0.5), Vec3(-0.5, 0.2, 1), Vec3(-0.5, -0.5, 1), Vec3(0, 0, 1)}) {
    const Vec3 from(-8, -8, 9);
    const trace::Intersection met =
        world.nearest_surface({from, (to - from).normalized()}, {0, 100});
    ASSERT_FALSE(met.none()) << to.transpose();
    EXPECT_NEAR(met.t_m, (to - from).norm(), 1e-5) << to.transpose();
  }
}

TEST(Solid, NonConvexFacesAreCutIntoTriangles) {
  Solid arrow;
  for (const auto& [x, y] : {std::pair{0., 0.}, {2., 0.}, {2., 2.}, {1., 0.5}, {0., 2.}}) {
    arrow.vertices.emplace_back(x, y, 3);
  }
  arrow.faces = {{0, 1, 2, 3, 4}};
  const SolidMesh mesh = triangulated(arrow);
  EXPECT_EQ(mesh.mesh.size(), 3u);
  EXPECT_NEAR(area(mesh.mesh), 2.5, 1e-6);
  EXPECT_FALSE(over_face(arrow, 0, {1, 1.5, 3}));
  EXPECT_TRUE(over_face(arrow, 0, {0.2, 1, 3}));
  Solid knot;
  for (const auto& [x, y] : {std::pair{0., 0.}, {2., 2.}, {2., 0.}, {0., 1.9}}) {
    knot.vertices.emplace_back(x, y, 0);
  }
  knot.faces = {{0, 1, 2, 3}};
  EXPECT_THROW(triangulated(knot), std::invalid_argument);
}

TEST(Solid, FilesSayTheSameAndBadOnesAreRefused) {
  const io::TemporaryFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    auto path = folder / name;
    std::ofstream(path) << text;
    return path;
  };
  const Solid a = read_solid(write("a.json", R"({"vertices": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]],
                                                 "faces": [[0,1,2,3]]})"));
  const Solid b = read_solid(write(
      "b.obj", "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 -2 4\n"));
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.faces, b.faces);
  int k = 0;
  for (const char* bad :
       {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "v 0 0\n", "v 0 0 0\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nf 1 2 3 4\n",
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "v nan 0 0\nf 1 1 1\n"}) {
    const auto path = write(("bad" + std::to_string(k++) + ".obj").c_str(), bad);
    EXPECT_THROW(read_solid(path), FormatError) << bad;
  }
  for (const char* bad : {"{", "{}", R"({"vertices": [[0, 0]], "faces": []})",
                          R"({"vertices": [[0, 0, 0]], "faces": [[0, -1, 5]]})"}) {
    const auto path = write(("bad" + std::to_string(k++) + ".json").c_str(), bad);
    EXPECT_THROW(read_solid(path), FormatError) << bad;
  }
  EXPECT_THROW(read_solid(folder / "none.obj"), FormatError);
}

}  // namespace
}  // namespace underbrush::studies
