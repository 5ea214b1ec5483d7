#include "underbrush/surface/implicit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/surface/surface.hpp"

namespace underbrush::surface {
namespace {

using Implicit = float (*)(const Vec3f&, std::span<const OrientedPoint>);
constexpr Implicit kSurfaces[] = {imls, rimls};

/// Makes points on z = 0 for |x|, |y| ≤ 1, with radius 1.
std::vector<OrientedPoint> flat(size_t n, double noise = 0) {
  Stream random(31);
  std::vector<OrientedPoint> points;
  for (size_t i = 0; i < n; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = noise * random.normal();
    points.push_back({Vec3f(float(x), float(y), float(z)), Vec3f(0, 0, 1), 1});
  }
  return points;
}

/// Finds where f crosses zero along z at (x, y), between −a and a.
double height(Implicit f, const std::vector<OrientedPoint>& points, float x, float y, float a) {
  float low = -a, high = a;
  for (int k = 0; k < 40; ++k) {
    const float middle = (low + high) / 2;
    (f({x, y, middle}, points) < 0 ? low : high) = middle;
  }
  return double(low);
}

TEST(Implicit, OfAPlaneIsTheDistance) {
  const Vec3f normal = Vec3f(1, -2, 4).normalized(), u = normal.unitOrthogonal();
  std::vector<OrientedPoint> points;
  for (const OrientedPoint& p : flat(300)) {
    points.push_back({p.position.x() * u + p.position.y() * normal.cross(u), normal, 2});
  }
  const Vec3f x = 0.3f * normal + Vec3f(0.1f, 0, 0);
  for (Implicit f : kSurfaces) {
    EXPECT_NEAR(f(x, points), 0.3 + 0.1 * double(normal.x()), 1e-5);
    EXPECT_TRUE(std::isnan(f(x, {})));
    EXPECT_TRUE(std::isnan(f(Vec3f(0, 0, 9), points)));  // out of reach
  }
}

TEST(Implicit, AverageTheNoise) {
  const auto points = flat(2000, 0.02);
  for (Implicit f : kSurfaces) {
    double squares = 0;
    for (int i = 0; i < 20; ++i) {
      const double z = height(f, points, 0.02f * float(i), -0.3f, 0.2f);
      squares += z * z;
    }
    EXPECT_LT(std::sqrt(squares / 20), 0.02 / 8);
  }
}

TEST(Implicit, RimlsPassesOverOutliersThatBendImls) {
  auto points = flat(400);
  for (size_t i = 0; i < points.size(); i += 10) points[i].position.z() += 0.4f;
  const double plain = height(imls, points, 0, 0, 0.3f), robust = height(rimls, points, 0, 0, 0.3f);
  EXPECT_GT(plain, 0.012);
  EXPECT_LT(std::abs(robust), plain / 5);
}

// The surface is the ridge of a roof whose halves are inclined by 45°, z = −|x|.
TEST(Implicit, RimlsKeepsAnEdgeThatImlsRounds) {
  auto points = flat(3000);
  for (OrientedPoint& p : points) {
    const float side = p.position.x() < 0 ? -1.0f : 1.0f;
    p.position.z() = -std::abs(p.position.x());
    p.normal = Vec3f(side, 0, 1).normalized();
    p.radius_m = 0.5f;
  }
  const auto error = [&](Implicit f) {
    double worst = 0;
    for (float x = 0; x < 0.5f; x += 0.02f) {
      worst = std::max(worst, std::abs(height(f, points, x, 0, 0.8f) + double(x)));
    }
    return worst;
  };
  EXPECT_GT(error(imls), 0.05);
  EXPECT_LT(error(rimls), error(imls) / 4);
}

// The radius error of a sphere falls with the square of the kernel.
TEST(Implicit, SphereConverges) {
  for (Implicit f : kSurfaces) {
    double last = 0;
    for (float radius : {0.6f, 0.3f}) {
      Stream random(33);
      std::vector<OrientedPoint> points;
      for (int i = 0; i < 20000; ++i) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        const Vec3f d = Vec3(x, y, z).normalized().cast<float>();
        if (d.z() > 0.7f) points.push_back({d, d, radius});
      }
      const double error = std::abs(double(f(Vec3f(0, 0, 1), points)));
      if (last > 0) {
        EXPECT_LT(error, last / 3);
      }
      last = error;
    }
  }
}

}  // namespace
}  // namespace underbrush::surface
