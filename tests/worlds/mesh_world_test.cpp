#include "underbrush/worlds/mesh_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::worlds {
namespace {

class MeshWorld : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  io::TemporaryFolder folder;
};

struct Corners {
  Vec3 a, b, c;
};

/// The range at which a ray meets a triangle (Möller and Trumbore) and its distance from the border
/// in barycentric units, in double precision.
std::optional<std::pair<double, double>> met(const Ray& ray, const Corners& t) {
  const Vec3 u = t.b - t.a, v = t.c - t.a, p = ray.direction.cross(v);
  const double det = u.dot(p);
  if (std::abs(det) < 1e-12) return std::nullopt;
  const Vec3 s = ray.origin - t.a, q = s.cross(u);
  const double x = s.dot(p) / det, y = ray.direction.dot(q) / det, z = v.dot(q) / det;
  const double border = std::min({x, y, 1 - x - y});
  if (border < -1e-6 || z <= 0) return std::nullopt;
  return std::pair{z, border};
}

// Law: a world of a mesh answers ray by ray what a brute-force test of all triangles answers.
TEST_F(MeshWorld, AnswersAsBruteForceDoes) {
  Stream random(3);
  const Vec3 place(412345.0, 5645678.0, 321.0);
  std::vector<Corners> triangles;
  std::string text;
  const auto point = [&](double spread) {
    const double x = random.uniform(-spread, spread), y = random.uniform(-spread, spread);
    return Vec3(x, y, random.uniform(-spread, spread));
  };
  for (int k = 0; k < 400; ++k) {
    const Vec3 middle = place + point(20);
    // Coordinates of millimetres, as such files have them.
    const auto corner = [&]() -> Vec3 {
      return ((middle + point(2)) * 1000).array().round().matrix() / 1000;
    };
    const Vec3 a = corner();
    const Vec3 b = corner();
    const Vec3 c = corner();
    triangles.push_back({a, b, c});
    char line[256];
    text += k % 40
                ? ""
                : "g part" + std::to_string(k / 40) + "\nusemtl m" + std::to_string(k % 3) + "\n";
    for (const Vec3& v : {a, b, c}) {
      std::snprintf(line, sizeof line, "v %.3f %.3f %.3f\n", v.x(), v.y(), v.z());
      text += line;
    }
    text += "f -3 -2 -1\n";
  }
  const World world = read_mesh_world(write("many.obj", text));
  EXPECT_EQ(world.report.parts, 10u);
  EXPECT_EQ(world.scene.instances.size(), 11u);
  EXPECT_LT(world.report.rounding_m, 2e-6);
  const trace::World traced(world.scene);
  size_t hits = 0, near_border = 0;
  for (int k = 0; k < 20000; ++k) {
    Ray ray;
    ray.origin = place + point(25);
    ray.direction = point(1).normalized();
    double expected = INFINITY;
    bool doubtful = false;
    for (const Corners& t : triangles) {
      const auto one = met(ray, t);
      if (!one) continue;
      doubtful |= one->second < 1e-5;
      expected = std::min(expected, one->first);
    }
    near_border += doubtful;
    if (doubtful) continue;
    const trace::Intersection got = traced.nearest_accepted(ray, k, {0, 120});
    ASSERT_EQ(!got.none(), expected < 120) << k;
    if (got.none()) continue;
    ++hits;
    EXPECT_NEAR(got.t_m, expected, 2e-4) << k;
    EXPECT_EQ(got.sigma_m, 0);
  }
  EXPECT_GT(hits, 1500u);
  EXPECT_LT(near_border, 100u);
}

TEST_F(MeshWorld, KeepsCoordinatesNearZeroToTheDigit) {
  const World world =
      read_mesh_world(write("a.obj", "o a\nv 0.1 -0.25 200\nv 1 0 0.5\nv 1.125 1 0\nf 1 2 3\n"));
  EXPECT_EQ(world.report.offset_m, Vec3::Zero());
  const auto& v = world.scene.models.at(1).surface.vertices;
  EXPECT_EQ(v.at(0), Vec3f(0.1f, -0.25f, 200));
  EXPECT_EQ(v.at(2), Vec3f(1.125f, 1, 0));
  EXPECT_EQ(world.scene.models.at(1).surface.range_sigma_m, 0);
  EXPECT_EQ(world.scene.models.at(0).size(), 0u);
}

TEST_F(MeshWorld, HasClassesAndMaterialsOfItsGroups) {
  write(
      "w.mtl",
      "# comment\nnewmtl soil dark\nhelios_isGround true\nhelios_reflectance 0.25\nKd 1 1 1\n"
      "newmtl roof\nhelios_classification 6\nhelios_spectra tile\nnewmtl glass\nhelios_shiny 1\n");
  std::string spectrum;
  for (int k = 0; k < 26; ++k) spectrum += "header\n";
  write("tile.txt", spectrum + "0.500\t10.0\n1.500\t30.0\n");
  const World w = read_mesh_world(
      write("w.obj",
            "mtllib w.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\no house\nusemtl soil dark\nf 1 2 3\n"
            "usemtl roof\nf 1 2 3\ng wall\nusemtl glass\nf 1 2 3\nusemtl nowhere\nf 1 2 3\n"
            "o large_tree\nusemtl roof\nf 1 2 3\nf 3 2 1\n"));
  ASSERT_EQ(w.info.labels.size(), 6u);
  std::vector<std::string> classes, materials(w.info.materials.begin() + 1, w.info.materials.end());
  for (size_t k = 1; k < 6; ++k) classes.push_back(elements::class_name(w.info, w.info.labels[k]));
  EXPECT_EQ(classes,
            (std::vector<std::string>{"ground", "las_6", "glass", "nowhere", "large_tree"}));
  EXPECT_EQ(materials, (std::vector<std::string>{"soil dark", "roof", "", "", "roof"}));
  EXPECT_EQ(w.info.names.at(1), "house / soil dark");
  EXPECT_EQ(w.scene.models.at(1).ground.size(), 1u);  // ground triangles count as ground
  EXPECT_EQ(w.scene.models.at(5).surface.size(), 2u);
  EXPECT_EQ(w.report.without_material, 2u);
  EXPECT_EQ(w.report.left_out.at("lines and points"), 1u);
  EXPECT_EQ(w.report.left_out.at("MTL lines of other kinds"), 1u);
  ASSERT_EQ(w.info.own_materials.size(), 2u);
  const auto& roof = w.info.own_materials[1].reflectance;
  ASSERT_EQ(roof.size(), 2u);
  EXPECT_DOUBLE_EQ(roof[0].first, 0.5e-6);
  EXPECT_DOUBLE_EQ(roof[1].second, 0.3);
}

TEST_F(MeshWorld, AnyNumberOfClassNamesIsRead) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int k = 0; k < 300; ++k) text += "g class number " + std::to_string(k) + "\nf 1 2 3\n";
  const World w = read_mesh_world(write("c.obj", text));
  EXPECT_EQ(w.info.class_names.size(), 242u);
  EXPECT_EQ(w.info.labels.back(), elements::Class::kUnknown);
  EXPECT_EQ(elements::class_name(w.info, w.info.labels.at(200)), "class number 199");
}

TEST_F(MeshWorld, StlIsTheSameInTextAndBytes) {
  const auto text =
      write("t.stl",
            "solid rock one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
            "vertex 0 1 0.5\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\n"
            "vertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0.5\nendloop\nendfacet\nendsolid\n");
  const float rows[2][12] = {{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5f},
                             {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 0.5f}};
  std::string bytes(84, ' ');
  const uint32_t n = 2;
  std::memcpy(bytes.data() + 80, &n, 4);
  for (const auto& row : rows) {
    bytes.append(reinterpret_cast<const char*>(row), sizeof row);
    bytes.append(2, '\0');
  }
  const World a = read_mesh_world(text), b = read_mesh_world(write("b.stl", bytes));
  for (const World* w : {&a, &b}) {
    EXPECT_EQ(w->report.triangles, 2u);
    EXPECT_EQ(w->scene.models.at(1).surface.vertices.size(), 4u);  // corners are shared
    EXPECT_EQ(w->scene.models[1].surface.vertices[2], Vec3f(0, 1, 0.5f));
  }
  EXPECT_EQ(elements::class_name(a.info, a.info.labels.at(1)), "rock");
  for (size_t keep : {0, 3, 83, 84, 100, 183}) {
    EXPECT_THROW(read_mesh_world(write("cut.stl", bytes.substr(0, keep))), FormatError) << keep;
  }
  // What people's programs write: words in capitals, bytes behind the triangles, "solid" in front.
  std::string capitals =
      "  SOLID Rock\nFACET NORMAL 0 0 1\n OUTER LOOP\n VERTEX -5.0E+01 0 0\n VERTEX 1 0 0\n"
      " VERTEX 0 1 0\n ENDLOOP\nENDFACET\nENDSOLID\n";
  const World c = read_mesh_world(write("c.STL", capitals));
  EXPECT_EQ(c.report.triangles, 1u);
  EXPECT_EQ(c.scene.models.at(1).surface.vertices.at(0), Vec3f(-50, 0, 0));
  std::string solid = bytes + "end";
  solid.replace(0, 5, "solid");
  const World d = read_mesh_world(write("d.stl", solid));
  EXPECT_EQ(d.report.triangles, 2u);
  EXPECT_EQ(d.report.left_out.at("bytes behind the last triangle"), 3u);
  EXPECT_THROW(read_mesh_world(write("more.stl", bytes + std::string(50, 'a'))), FormatError);
  const uint32_t absurd = 0xffffffff;
  std::memcpy(bytes.data() + 80, &absurd, 4);
  EXPECT_THROW(read_mesh_world(write("absurd.stl", bytes)), FormatError);
}

TEST_F(MeshWorld, AxesAndUnitAreApplied) {
  const auto file = write("y.obj", "v 0 0 0\nv 100 0 0\nv 0 200 50\nf 1 2 3\n");
  const World w = read_mesh_world(file, {0.01, "y"});
  EXPECT_EQ(w.scene.models.at(1).surface.vertices.at(2), Vec3f(0, -0.5f, 2));
  EXPECT_TRUE(w.report.y_up);
}

TEST_F(MeshWorld, RefusesWhatIsWrong) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const std::string& text :
       {std::string(), v, v + "f 1 2 4\n", "v 1e10 0 0\n" + v + "f 1 2 3\n",
        "mtllib ../w.mtl\n" + v + "f 1 2 3\n", "mtllib /etc/passwd\n" + v + "f 1 2 3\n"}) {
    EXPECT_THROW(read_mesh_world(write("bad.obj", text)), FormatError) << text;
  }
  const std::string obj = "mtllib bad.mtl\n" + v + "f 1 2 3\n";
  for (const std::string text :
       {"newmtl a\nhelios_reflectance 1.5\n", "newmtl a\nhelios_reflectance\n",
        "newmtl a\nhelios_classification 256\n", "newmtl a\nhelios_spectra ../x\n"}) {
    write("bad.mtl", text);
    EXPECT_THROW(read_mesh_world(write("b.obj", obj)), FormatError) << text;
  }
  std::filesystem::remove(folder / "bad.mtl");
  EXPECT_EQ(read_mesh_world(write("b.obj", obj)).report.left_out.at("MTL files that are not there"),
            1u);
}

TEST_F(MeshWorld, KnowsAMeshFromALog) {
  EXPECT_TRUE(is_mesh(write("a.obj", "")));
  EXPECT_FALSE(is_mesh(folder / "none.obj"));
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n";
  EXPECT_FALSE(is_mesh(write("a.ply", head + "end_header\n0\n")));
  EXPECT_TRUE(is_mesh(write(
      "b.ply",
      head + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0\n3 0 0 0\n")));
  EXPECT_FALSE(is_mesh(write("c.ply", "not a ply")));
}

}  // namespace
}  // namespace underbrush::worlds
