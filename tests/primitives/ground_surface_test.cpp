#include "underbrush/primitives/ground_surface.hpp"

#include <gtest/gtest.h>

#include "primitives/sites.hpp"

namespace underbrush::primitives {
namespace {

TEST(GroundSurface, IsThePlaneThatItsTrianglesAre) {
  const elements::Model m = test::plane(8, 0.3, -0.1);
  const GroundSurface ground(m);
  Stream random(1);
  for (int k = 0; k < 1000; ++k) {
    const double x = random.uniform(-9, 9), y = random.uniform(-9, 9);
    const auto z = ground.at(10 + x, -20 + y);
    ASSERT_EQ(z.has_value(), std::abs(x) <= 8 && std::abs(y) <= 8) << x << " " << y;
    if (z) {
      ASSERT_NEAR(*z, 3 + 0.3 * x - 0.1 * y, 1e-5);
    }
  }
}

// The reference tests each triangle in turn, on a bumpy mesh with a hole.
TEST(GroundSurface, AgreesWithASlowReference) {
  elements::Model m;
  Stream random(2);
  constexpr uint32_t kSide = 20;
  for (uint32_t j = 0; j <= kSide; ++j) {
    for (uint32_t i = 0; i <= kSide; ++i) {
      const double dx = random.uniform(-0.3, 0.3), dy = random.uniform(-0.3, 0.3);
      m.ground.vertices.emplace_back(float(i + dx), float(j + dy), float(random.normal()));
    }
  }
  for (uint32_t j = 0; j < kSide; ++j) {
    for (uint32_t i = 0; i < kSide; ++i) {
      if (i == 7 && j == 9) continue;
      const uint32_t v = j * (kSide + 1) + i;
      m.ground.triangles.push_back({v, v + 1, v + kSide + 2});
      m.ground.triangles.push_back({v, v + kSide + 2, v + kSide + 1});
    }
  }
  m.ground.hit.resize(m.ground.size());
  const GroundSurface ground(m);
  int none = 0;
  for (int k = 0; k < 4000; ++k) {
    const Eigen::Vector2d p(random.uniform(0.5, 19.5), random.uniform(0.5, 19.5));
    std::optional<double> slow;
    for (const auto& t : m.ground.triangles) {
      Eigen::Matrix3d a;
      for (int c = 0; c < 3; ++c) {
        a.col(c) << m.ground.vertices[t[size_t(c)]].head<2>().cast<double>(), 1;
      }
      const Vec3 w = a.inverse() * Vec3(p.x(), p.y(), 1);
      if (w.minCoeff() < 0) continue;
      double z = 0;
      for (int c = 0; c < 3; ++c) z += w[c] * double(m.ground.vertices[t[size_t(c)]].z());
      slow = slow ? std::max(*slow, z) : z;
    }
    const auto fast = ground.at(p.x(), p.y());
    none += !fast;
    ASSERT_EQ(fast.has_value(), slow.has_value());
    if (fast) {
      ASSERT_NEAR(*fast, *slow, 1e-9);
    }
  }
  EXPECT_GT(none, 0);  // points in the hole have no ground
}

TEST(GroundSurface, NeedsTriangles) {
  const elements::Model none;
  EXPECT_THROW(GroundSurface{none}, std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::primitives
