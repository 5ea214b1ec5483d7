#include "underbrush/primitives/adapt.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "primitives/layers.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/primitives/measure.hpp"

namespace underbrush::primitives {
namespace {

constexpr size_t kEllipsoids = 1000;
const double kHalf = std::pow(0.5, 0.75), kDouble = std::pow(2, 0.75), kMost = std::pow(5, 0.75);

/// A body of ellipsoids, denser towards its lower corner by the exponents `bend`, in a box of this
/// size, with the layers of its ellipsoids.
struct Body {
  elements::Model model;
  PlacedObject object;
  PrimitiveEntry entry() const {
    PrimitiveEntry e;
    e.box = object.box;
    e.layers = object.layers;
    e.beams = object.beams;
    return e;
  }
};

PointLayers layers_of(const elements::Model& model) {
  std::vector<Vec3> points;
  for (const elements::Ellipsoid& e : model.ellipsoids) points.push_back(e.mean.cast<double>());
  return primitives::layers_of(std::move(points));
}

/// The greatest difference between places of layers, m.
double difference(const PointLayers& a, const PointLayers& b) {
  double most = 0;
  for (size_t l = 0; l < 5; ++l) {
    for (size_t q = 0; q < 5; ++q) {
      most = std::max({most, std::abs(a.z[l] - b.z[l]), std::abs(a.x[l][q] - b.x[l][q]),
                       std::abs(a.y[l][q] - b.y[l][q])});
    }
  }
  return most;
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
  out.object.layers = layers_of(out.model);
  return out;
}

TEST(Adapt, ElementsLieWhereThePointsOfTheObjectDo) {
  const Body from = body(1, Vec3(3, 2, 5), Vec3(1, 3, 0.4));
  const Body to = body(2, Vec3(4, 1.5, 7), Vec3(2, 0.5, 1.5));
  const elements::Model m = adapted(from.model, from.entry(), to.object);
  EXPECT_LT(difference(layers_of(m), to.object.layers), 0.2);  // between layers the maps are mixed
  EXPECT_GT(difference(from.object.layers, to.object.layers), 1);
  for (size_t k = 0; k < kEllipsoids; ++k) {
    EXPECT_EQ(from.model.ellipsoids[k].hit.p, m.ellipsoids[k].hit.p);  // The beams are not known.
    EXPECT_GE(m.ellipsoids[k].mean.z(), to.object.box.min.z() - 1e-5);
    EXPECT_LE(m.ellipsoids[k].mean.z(), to.object.box.max.z() + 1e-5);
  }
}

/// A trunk of the width 0.4 m about (x, 0) up to 2 m, under a crown of the width 4 m about (0, 0).
Body tree(uint64_t seed, double trunk_x) {
  Body out = body(seed, Vec3(4, 4, 5), Vec3(1, 1, 1));
  for (elements::Ellipsoid& e : out.model.ellipsoids) {
    if (e.mean.z() >= 2) continue;
    e.mean.x() = float(0.1 * double(e.mean.x()) + trunk_x);
    e.mean.y() *= 0.1F;
  }
  out.object.layers = layers_of(out.model);
  return out;
}

TEST(Adapt, EachLayerMovesByItself) {
  const Body from = tree(6, -1), to = tree(7, 1.5);
  const elements::Model m = adapted(from.model, from.entry(), to.object);
  for (size_t k = 0; k < kEllipsoids; ++k) {
    const Vec3f &was = from.model.ellipsoids[k].mean, &is = m.ellipsoids[k].mean;
    const bool is_trunk = was.z() < 1.4F;
    const bool is_crown = was.z() > 2.6F;
    EXPECT_TRUE(!is_trunk || std::abs(is.x() - was.x() - 2.5F) < 0.15F) << is.x() << " " << was.x();
    EXPECT_TRUE(!is_crown || std::abs(is.x() - was.x()) < 0.5F) << is.x() << " " << was.x();
  }
}

TEST(Adapt, EllipsoidsStretchByTheRootOfTheirSurroundings) {
  const Body from = body(8, Vec3(3, 2, 4), Vec3(1, 1, 1));
  Body to = from;
  for (elements::Ellipsoid& e : to.model.ellipsoids) {
    e.mean = Vec3f(2.25F * e.mean.x(), e.mean.y(), 0.49F * e.mean.z());
  }
  to.object.box.max.z() *= 0.49;
  to.object.layers = layers_of(to.model);
  elements::Model thin = from.model;
  for (elements::Ellipsoid& e : thin.ellipsoids) e.set_covariance(0.01 * Mat3::Identity());
  double x = 0, y = 0, z = 0;
  for (const elements::Ellipsoid& e : adapted(thin, from.entry(), to.object).ellipsoids) {
    const Vec3 sides = e.covariance_matrix().diagonal().cwiseSqrt() / 0.1;
    x += sides.x() / double(kEllipsoids);
    y += sides.y() / double(kEllipsoids);
    z += sides.z() / double(kEllipsoids);
  }
  EXPECT_NEAR(x, 1.5, 0.1);  // less beyond the outer places, where the map is a shift
  EXPECT_NEAR(y, 1, 0.01);
  EXPECT_NEAR(z, 0.7, 0.02);
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
  to.layers = layers_at(Vec3(0.1, 0.2, 0.3));
  to.box.max.z() = 0.05;
  PrimitiveEntry flat = from.entry();
  flat.layers = layers_at(Vec3(0.1, 0.2, 0.3));
  for (const PrimitiveEntry& e : {from.entry(), flat}) {
    for (const elements::Ellipsoid& x : adapted(from.model, e, to).ellipsoids) {
      EXPECT_TRUE(x.mean.allFinite());
      EXPECT_LT(x.mean.norm(), 10);
    }
  }
  to.layers = {};
  EXPECT_FALSE(can_adapt(from.entry(), to));
  EXPECT_THROW(adapted(from.model, from.entry(), to), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::primitives
