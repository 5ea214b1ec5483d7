#include "underbrush/primitives/adapt.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::primitives {
namespace {

constexpr size_t kEllipsoids = 1000;
const double kHalf = std::pow(0.5, 0.75), kDouble = std::pow(2, 0.75), kMost = std::pow(5, 0.75);

/// A body of ellipsoids, denser towards its lower corner by the exponents `bend`, in a box of this
/// size, with the quantiles of its ellipsoids.
struct Body {
  elements::Model model;
  PlacedObject object;
  PrimitiveEntry entry() const {
    PrimitiveEntry e;
    e.box = object.box;
    e.quantiles = object.quantiles;
    e.beams = object.beams;
    return e;
  }
};

std::array<Vec3, 5> quantiles_of(const elements::Model& model) {
  std::array<Vec3, 5> out;
  for (int d = 0; d < 3; ++d) {
    std::vector<float> x;
    for (const elements::Ellipsoid& e : model.ellipsoids) x.push_back(e.mean[d]);
    std::sort(x.begin(), x.end());
    for (size_t q = 0; q < 5; ++q) {
      out[q][d] = double(x[size_t(PlacedObject::kShares[q] * double(x.size() - 1))]);
    }
  }
  return out;
}

Body body(uint64_t seed, const Vec3& size, const Vec3& bend) {
  Stream random(seed);
  Body out;
  out.object.box = {Vec3(-0.5 * size.x(), -0.5 * size.y(), 0),
                    Vec3(0.5 * size.x(), 0.5 * size.y(), size.z())};
  for (size_t k = 0; k < kEllipsoids; ++k) {
    elements::Ellipsoid e;
    for (int d = 0; d < 3; ++d) {
      const double at = std::pow(random.uniform(), bend[d]);
      e.mean[d] = float(out.object.box.min[d] + size[d] * at);
    }
    e.hit.p = 0.3F;
    e.density_per_m = 2;
    out.model.ellipsoids.push_back(e);
  }
  out.object.quantiles = quantiles_of(out.model);
  return out;
}

TEST(Adapt, ElementsLieWhereThePointsOfTheObjectDo) {
  const Body from = body(1, Vec3(3, 2, 5), Vec3(1, 3, 0.4));
  const Body to = body(2, Vec3(4, 1.5, 7), Vec3(2, 0.5, 1.5));
  const elements::Model m = adapted(from.model, from.entry(), to.object);
  const std::array<Vec3, 5> got = quantiles_of(m);
  for (size_t q = 0; q < 5; ++q) EXPECT_LT((got[q] - to.object.quantiles[q]).norm(), 1e-4);
  for (size_t k = 0; k < kEllipsoids; ++k) {
    const elements::Ellipsoid &a = from.model.ellipsoids[k], &b = m.ellipsoids[k];
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.hit.p, b.hit.p);  // The beams are not known.
    EXPECT_TRUE((b.mean.cast<double>() - to.object.box.min).minCoeff() > -1e-5);
    EXPECT_TRUE((to.object.box.max - b.mean.cast<double>()).minCoeff() > -1e-5);
  }
}

TEST(Adapt, ToItselfChangesNothing) {
  Body one = body(3, Vec3(3, 2, 5), Vec3(1, 2, 1));
  one.object.beams = {{10, 200, 3000}, {100, 400, 9000}};
  const elements::Model m = adapted(one.model, one.entry(), one.object);
  for (size_t k = 0; k < kEllipsoids; ++k) {
    const elements::Ellipsoid &a = one.model.ellipsoids[k], &b = m.ellipsoids[k];
    EXPECT_LT((a.mean - b.mean).norm(), 1e-5);
    EXPECT_NEAR(a.hit.p, b.hit.p, 1e-6);
    EXPECT_NEAR(a.density_per_m, b.density_per_m, 1e-6);
  }
}

TEST(Adapt, OpticalDepthFollowsTheReturnsOfEachThird) {
  Body from = body(4, Vec3(3, 3, 3), Vec3(1, 1, 1));
  from.object.beams = {{1e6, 1e6, 1e6}, {1e6, 1e6, 1e6}};
  PlacedObject to = from.object;
  to.beams = {{1e6, 2e6, 2e7}, {2e6, 1e6, 1e6}};  // half, double, and beyond the limit
  const elements::Model m = adapted(from.model, from.entry(), to);
  for (size_t k = 0; k < kEllipsoids; ++k) {
    const elements::Ellipsoid &a = from.model.ellipsoids[k], &b = m.ellipsoids[k];
    const double ratio = std::log1p(-double(b.hit.p)) / std::log1p(-double(a.hit.p));
    const float z = b.mean.z();
    const double wanted = z < 0.999F   ? kHalf
                          : z < 1      ? ratio
                          : z < 1.999F ? kDouble
                          : z < 2      ? ratio
                                       : kMost;
    EXPECT_NEAR(ratio, wanted, 2e-3 * wanted);
    EXPECT_NEAR(b.density_per_m / a.density_per_m, wanted, 2e-3 * wanted);
  }
  to.beams = {{0, 2, 0}, {1, 1, 1}};  // Too few beams to tell.
  for (const elements::Ellipsoid& e : adapted(from.model, from.entry(), to).ellipsoids) {
    EXPECT_NEAR(e.density_per_m, 2, 0.1);
  }
}

TEST(Adapt, FlatBodiesStayFinite) {
  const Body from = body(5, Vec3(3, 2, 5), Vec3(1, 1, 1));
  PlacedObject to = from.object;
  to.quantiles.fill(Vec3(0.1, 0.2, 0.3));
  to.box.max.z() = 0.05;
  PrimitiveEntry flat = from.entry();
  flat.quantiles.fill(Vec3(0.1, 0.2, 0.3));
  for (const PrimitiveEntry& e : {from.entry(), flat}) {
    for (const elements::Ellipsoid& x : adapted(from.model, e, to).ellipsoids) {
      EXPECT_TRUE(x.mean.allFinite());
      EXPECT_LT(x.mean.norm(), 10);
    }
  }
  to.quantiles = PlacedObject{}.quantiles;
  EXPECT_FALSE(can_adapt(from.entry(), to));
  EXPECT_THROW(adapted(from.model, from.entry(), to), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::primitives
