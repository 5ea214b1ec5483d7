#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "underbrush/core/ray.hpp"
#include "underbrush/test_site/grass.hpp"
#include "underbrush/test_site/shrub.hpp"
#include "underbrush/test_site/tree.hpp"

namespace underbrush::test_site {
namespace {

constexpr uint64_t kSeed = 20;

std::array<Vec3, 3> corners(const elements::TriangleMesh& mesh, size_t triangle) {
  std::array<Vec3, 3> c;
  for (size_t k = 0; k < 3; ++k) {
    c[k] = mesh.vertices[mesh.triangles[triangle][k]].cast<double>();
  }
  return c;
}

Vec3 unit_normal(const elements::TriangleMesh& mesh, size_t triangle) {
  const auto [a, b, c] = corners(mesh, triangle);
  return (b - a).cross(c - a).normalized();
}

bool meets(const Ray& ray, const std::array<Vec3, 3>& c) {
  const Vec3 e1 = c[1] - c[0], e2 = c[2] - c[0], p = ray.direction.cross(e2);
  const double det = e1.dot(p);
  if (std::abs(det) < 1e-14) return false;
  const Vec3 s = ray.origin - c[0], q = s.cross(e1);
  const double u = s.dot(p) / det, v = ray.direction.dot(q) / det;
  return u >= 0 && v >= 0 && u + v <= 1;
}

void expect_sound(const PlantMesh& plant) {
  ASSERT_EQ(plant.part.size(), plant.mesh.size());
  elements::Model model;
  model.surface = plant.mesh;
  EXPECT_NO_THROW(model.check());
  size_t degenerate = 0;
  for (size_t i = 0; i < plant.mesh.size(); ++i) degenerate += triangle_area(plant.mesh, i) < 1e-8;
  EXPECT_EQ(degenerate, 0u);
}

TEST(Tube, OfConstantRadiusHasTheAreaOfAPrismAndACone) {
  PlantMesh plant;
  const std::vector<TubePoint> axis = {
      {Vec3(0, 0, 0), 0.1}, {Vec3(0, 0, 1), 0.1}, {Vec3(0, 0, 2), 0.1}, {Vec3(0, 0, 2.5), 0}};
  add_tube(plant, axis, 6);
  const double side = 2 * 0.1 * std::sin(M_PI / 6), apothem = 0.1 * std::cos(M_PI / 6);
  EXPECT_NEAR(part_area(plant, Part::kWood), 6 * side * (2 + 0.5 * std::hypot(apothem, 0.5)), 1e-6);
  expect_sound(plant);
}

class Trees : public testing::TestWithParam<Species> {
 protected:
  TreeParameters parameters() const { return typical_tree(GetParam(), 7); }
};
INSTANTIATE_TEST_SUITE_P(All, Trees, testing::Values(Species::kBroadleaf, Species::kConifer));

TEST_P(Trees, HaveTheSizeAndLeafAreaAskedFor) {
  const TreeParameters p = parameters();
  const PlantMesh plant = tree(p, kSeed);
  expect_sound(plant);
  EXPECT_NEAR(part_area(plant, Part::kLeaf), p.foliage.area_m2, 1e-4 * p.foliage.area_m2);
  const Eigen::AlignedBox3d box = bounds(plant.mesh);
  EXPECT_NEAR(box.max().z(), p.height_m, 0.02 * p.height_m);
  EXPECT_GT(box.min().z(), -0.05);
  EXPECT_NEAR(box.sizes().head<2>().maxCoeff(), 2 * p.crown_radius_m, 0.4 * p.crown_radius_m);
}

TEST_P(Trees, BranchFromOneFootWithoutGaps) {
  const TreeParameters p = parameters();
  Stream random(kSeed);
  const Skeleton skeleton = tree_skeleton(p, random);
  ASSERT_GT(skeleton.size(), 500u);
  EXPECT_EQ(skeleton.parent[0], -1);
  EXPECT_TRUE(skeleton.position[0].isZero());
  double longest_m = 0;
  for (size_t i = 1; i < skeleton.size(); ++i) {
    ASSERT_GE(skeleton.parent[i], 0) << "a second root";
    ASSERT_LT(skeleton.parent[i], int32_t(i));
    longest_m = std::max(longest_m, skeleton.segment(i).norm());
  }
  EXPECT_LT(longest_m, 1.5 * p.twig_spacing_m);
}

// The wood covers the whole skeleton: tubes start at the foot or on the axis of another branch, and
// each end of a branch is the apex of a tube.
TEST_P(Trees, HaveWoodUpToEveryTip) {
  Stream random(kSeed);
  const Skeleton skeleton = tree_skeleton(parameters(), random);
  PlantMesh plant;
  add_wood(plant, skeleton, pipe_radii(carried_tips(skeleton), 0.1, 0.002));
  std::vector<bool> bears(skeleton.size(), false);
  for (size_t i = 1; i < skeleton.size(); ++i) bears[size_t(skeleton.parent[i])] = true;
  const auto key = [](const Vec3f& v) { return std::array<float, 3>{v.x(), v.y(), v.z()}; };
  std::set<std::array<float, 3>> vertices;
  for (const Vec3f& v : plant.mesh.vertices) vertices.insert(key(v));
  size_t missing = 0;
  for (size_t i = 0; i < skeleton.size(); ++i) {
    missing += !bears[i] && !vertices.contains(key(skeleton.position[i].cast<float>()));
  }
  EXPECT_EQ(missing, 0u);
}

TEST_P(Trees, RepeatThemselvesByTheirSeed) {
  const PlantMesh a = tree(parameters(), 3), b = tree(parameters(), 3), c = tree(parameters(), 4);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_NE(a.mesh.vertices, c.mesh.vertices);
}

TEST(PipeModel, AddsUpOverEveryFork) {
  Stream random(kSeed);
  const Skeleton skeleton = tree_skeleton(typical_tree(Species::kBroadleaf, 7), random);
  const std::vector<uint32_t> tips = carried_tips(skeleton);
  const std::vector<double> radii = pipe_radii(tips, 0.1, 0.002);
  const double power = std::log(double(tips[0])) / std::log(0.1 / 0.002);
  EXPECT_NEAR(radii[0], 0.1, 1e-12);
  std::vector<double> carried(skeleton.size(), 0);
  for (size_t i = 1; i < skeleton.size(); ++i) {
    carried[size_t(skeleton.parent[i])] += std::pow(radii[i], power);
  }
  for (size_t i = 0; i < skeleton.size(); ++i) {
    const double expected = carried[i] > 0 ? carried[i] : std::pow(0.002, power);
    EXPECT_NEAR(std::pow(radii[i], power), expected, 1e-9 * expected);
  }
}

class Leaves : public testing::TestWithParam<LeafAngle> {};
INSTANTIATE_TEST_SUITE_P(All, Leaves,
                         testing::Values(LeafAngle::kSpherical, LeafAngle::kUniform,
                                         LeafAngle::kPlanophile, LeafAngle::kErectophile,
                                         LeafAngle::kPlagiophile, LeafAngle::kExtremophile));

// The test is χ² of the normals' zenith angles in 24 classes of equal probability, with seed 20.
TEST_P(Leaves, StandAtTheAnglesOfTheirDistribution) {
  ShrubParameters p = typical_shrub(1.5);
  p.foliage.angles = GetParam();
  const PlantMesh plant = shrub(p, kSeed);
  std::array<double, 24> cell{};
  double n = 0;
  for (size_t i = 0; i < plant.mesh.size(); ++i) {
    if (plant.part[i] != Part::kLeaf) continue;
    ++i;  // the second half of the same leaf
    const double zenith = std::acos(std::min(1.0, std::abs(unit_normal(plant.mesh, i).z())));
    const double u = leaf_angle_cdf(GetParam(), zenith);
    ++cell[std::min<size_t>(size_t(u * double(cell.size())), cell.size() - 1)];
    ++n;
  }
  ASSERT_GT(n, 2000);
  double chi2 = 0;
  for (double c : cell) chi2 += (c - n / 24) * (c - n / 24) / (n / 24);
  EXPECT_LT(chi2, 23 + 5 * std::sqrt(2 * 23.0));
}

// Where leaves are at random places within a cell of 20 cm, a beam passes the crown with
// probability exp(−G Σ λ l) by the law of Beer and Lambert. λ is the leaf area density of each cell
// and l the path in it.
TEST_P(Leaves, LetBeamsThroughByBeerLambert) {
  ShrubParameters p = typical_shrub(1.6);
  p.foliage.angles = GetParam();
  const PlantMesh plant = shrub(p, kSeed);
  constexpr double kCell = 0.2;
  std::map<std::array<int, 3>, double> leaf_area;
  const auto cell = [](const Vec3& v) {
    return std::array<int, 3>{int(std::floor(v.x() / kCell)), int(std::floor(v.y() / kCell)),
                              int(std::floor(v.z() / kCell))};
  };
  std::vector<std::array<Vec3, 3>> leaves;
  for (size_t i = 0; i < plant.mesh.size(); ++i) {
    if (plant.part[i] != Part::kLeaf) continue;
    leaves.push_back(corners(plant.mesh, i));
    const auto& c = leaves.back();
    leaf_area[cell((c[0] + c[1] + c[2]) / 3)] += triangle_area(plant.mesh, i);
  }
  Stream random(kSeed);
  const double zenith = 0.9, g = leaf_projection(GetParam(), zenith);
  double expected = 0, passed = 0;
  const int n = 1000;
  for (int i = 0; i < n; ++i) {
    const double azimuth = random.uniform(0, 2 * M_PI), x = random.uniform(-0.5, 0.5);
    const double y = random.uniform(-0.5, 0.5), z = random.uniform(0.5, 1.3);
    const Vec3 to(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                  std::cos(zenith));
    const Ray ray{Vec3(x, y, z) - 3 * to, to};
    double depth = 0;
    for (double t = 0.005; t < 6; t += 0.01) {
      const auto found = leaf_area.find(cell(ray.at(t)));
      if (found != leaf_area.end()) depth += found->second / std::pow(kCell, 3) * 0.01;
    }
    expected += std::exp(-g * depth) / n;
    bool hit = false;
    for (size_t k = 0; k < leaves.size() && !hit; ++k) hit = meets(ray, leaves[k]);
    passed += hit ? 0 : 1.0 / n;
  }
  EXPECT_GT(expected, 0.1);
  EXPECT_LT(expected, 0.6);
  // Leaves gather along twigs, which lets a little more light through, but never less.
  EXPECT_GT(passed, expected - 0.02);
  EXPECT_LT(passed, expected + 0.08);
}

TEST(Shrub, HasTheSizeAndLeafAreaAskedFor) {
  for (const double h : {0.35, 0.8, 1.5, 2.6}) {
    const ShrubParameters p = typical_shrub(h);
    const PlantMesh plant = shrub(p, kSeed);
    expect_sound(plant);
    EXPECT_NEAR(part_area(plant, Part::kLeaf), p.foliage.area_m2, 1e-4 * p.foliage.area_m2);
    const Eigen::AlignedBox3d box = bounds(plant.mesh);
    EXPECT_NEAR(box.max().z(), h, 0.03 + 0.03 * h);
    EXPECT_GT(box.min().z(), -0.06);
    EXPECT_NEAR(box.sizes().x(), 2 * p.radius_m, 0.5 * p.radius_m);
  }
}

TEST(Grass, HasTheHeightAndDensityAskedFor) {
  GrassParameters p;
  p.size_m = 3;
  for (const int segments : {1, 2, 4}) {
    p.segments = segments;
    const PlantMesh plant = grass_patch(p, kSeed);
    expect_sound(plant);
    const auto blade = size_t(2 * segments - 1), blades = plant.mesh.size() / blade;
    EXPECT_EQ(blades, size_t(400 * 9));
    double mean = 0, square = 0;
    for (size_t i = 0; i < blades; ++i) {
      const Vec3 tip = corners(plant.mesh, (i + 1) * blade - 1)[2];
      const Vec3 root = corners(plant.mesh, i * blade)[0];
      EXPECT_NEAR(root.z(), 0, 1e-6);
      EXPECT_LT(root.head<2>().cwiseAbs().maxCoeff(), 1.51);
      mean += tip.z() / double(blades);
      square += tip.z() * tip.z() / double(blades);
    }
    EXPECT_NEAR(mean, p.height_m, 5 * 0.2 * p.height_m / std::sqrt(double(blades)));
    EXPECT_NEAR(std::sqrt(square - mean * mean), 0.2 * p.height_m, 0.01);
  }
}

TEST(Grass, MowedIsShortAndEven) {
  const PlantMesh plant = grass_patch(mowed_grass(1), kSeed);
  expect_sound(plant);
  EXPECT_EQ(plant.mesh.size(), 1500u);
  EXPECT_LT(bounds(plant.mesh).max().z(), 0.09);
}

TEST(Plants, RefuseImpossibleSizes) {
  TreeParameters t = typical_tree(Species::kBroadleaf, 7);
  t.crown_base_m = 8;
  EXPECT_THROW(tree(t, 1), std::invalid_argument);
  t = typical_tree(Species::kBroadleaf, 7);
  t.foliage.leaf_length_m = 0;
  EXPECT_THROW(tree(t, 1), std::invalid_argument);
  ShrubParameters s;
  s.stems = 0;
  EXPECT_THROW(shrub(s, 1), std::invalid_argument);
  GrassParameters g;
  g.height_m = -1;
  EXPECT_THROW(grass_patch(g, 1), std::invalid_argument);
  EXPECT_THROW(tussock({}, 0, 1), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::test_site
