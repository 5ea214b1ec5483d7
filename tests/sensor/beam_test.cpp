#include "underbrush/sensor/beam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/angles.hpp"

namespace underbrush::sensor {
namespace {

BeamShape shape_of(Profile profile, Growth growth = Growth::kCone) {
  BeamShape s;
  s.divergence_rad = {0.004, 0.001};
  s.exit_diameter_m = 0.02;
  s.profile = profile;
  s.growth = growth;
  if (profile == Profile::kTable) {
    s.table = {0, 1, 2, 3, 0, 1};
    s.table_columns = 3;
  }
  return s;
}

float sum_of(const std::vector<SubRay>& rays, bool backwards) {
  float sum = 0;
  for (size_t k = 0; k < rays.size(); ++k) {
    sum += rays[backwards ? rays.size() - 1 - k : k].weight;
  }
  return sum;
}

TEST(SubRays, WeightsSumToExactlyOneInAnyOrder) {
  for (Profile p : {Profile::kUniform, Profile::kGaussian, Profile::kTable}) {
    for (int n = 1; n < 60; ++n) {
      std::vector<SubRay> rays = grid_sub_rays(shape_of(p), n, (n * 7) % 11 + 1);
      EXPECT_EQ(sum_of(rays, false), 1) << n;
      EXPECT_EQ(sum_of(rays, true), 1) << n;
      if (p != Profile::kTable) {
        EXPECT_EQ(sum_of(spread_sub_rays(shape_of(p), n), false), 1) << n;
      }
    }
  }
  Stream random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> shares(1 + random.below(300));
    for (double& s : shares) s = std::exp(random.uniform(-30, 3));
    std::vector<float> w = exact_weights(shares);
    EXPECT_EQ(std::accumulate(w.begin(), w.end(), 0.0f), 1);
    std::sort(w.begin(), w.end());
    EXPECT_EQ(std::accumulate(w.begin(), w.end(), 0.0f), 1);
  }
}

// Σ w u² of a profile in units of its half-width is 1/4 for a uniform disc and 1/(2 ln 2) for a
// Gaussian.
TEST(SubRays, HaveTheSecondMomentsOfTheirProfile) {
  const auto moment = [](const std::vector<SubRay>& rays) {
    std::array<double, 4> m{};  // mean of u, of v, of u², of v²
    for (const SubRay& s : rays) {
      m[0] += double(s.weight) * s.u;
      m[1] += double(s.weight) * s.v;
      m[2] += double(s.weight) * s.u * s.u;
      m[3] += double(s.weight) * s.v * s.v;
    }
    return m;
  };
  const double gaussian = 1 / (2 * M_LN2);
  for (const auto& [profile, square] :
       {std::pair(Profile::kUniform, 0.25), std::pair(Profile::kGaussian, gaussian)}) {
    for (const auto& m : {moment(spread_sub_rays(shape_of(profile), 2000)),
                          moment(grid_sub_rays(shape_of(profile), 60, 60))}) {
      EXPECT_NEAR(m[0], 0, 1e-3);
      EXPECT_NEAR(m[1], 0, 1e-3);
      EXPECT_NEAR(m[2], square, 0.04 * square);
      EXPECT_NEAR(m[3], square, 0.04 * square);
    }
  }
}

TEST(SubRays, OfATableAreItsCells) {
  const std::vector<SubRay> rays = grid_sub_rays(shape_of(Profile::kTable), 3, 2);
  ASSERT_EQ(rays.size(), 4u);  // two cells are empty
  const double u[] = {0, 2.0 / 3, -2.0 / 3, 2.0 / 3}, v[] = {-0.5, -0.5, 0.5, 0.5};
  const double weight[] = {1, 2, 3, 1};
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(rays[k].u, u[k], 1e-6);
    EXPECT_NEAR(rays[k].v, v[k], 1e-6);
    EXPECT_NEAR(rays[k].weight, weight[k] / 7, 1e-7);
  }
}

// The footprint's edge and the RMS radius of the sub-rays grow with the range as the shape says.
TEST(SubRays, FootprintGrowsAsTheShapeSays) {
  const Ray axis{Vec3(1, 2, 3), unit_vector(0.7, -0.3)};
  for (Growth growth : {Growth::kCone, Growth::kWaist}) {
    const BeamShape s = shape_of(Profile::kUniform, growth);
    const BeamAxes beam = beam_axes(axis);
    const RayMaker maker(s);
    EXPECT_NEAR(beam.right.z(), 0, 1e-15);
    EXPECT_GT(beam.up.z(), 0.9);
    for (double range : {0.0, 2.5, 10.0, 100.0}) {
      const auto [w, h] = s.half_width_m(range);
      const double cone_w = 0.01 + range * std::tan(0.002), cone_h = 0.01 + range * std::tan(5e-4);
      if (growth == Growth::kCone) {
        EXPECT_NEAR(w, cone_w, 1e-12);
        EXPECT_NEAR(h, cone_h, 1e-12);
      } else {
        EXPECT_NEAR(w, std::hypot(0.01, cone_w - 0.01), 1e-12);
      }
      double right = 0, up = 0;
      for (const SubRay& sub : spread_sub_rays(s, 4000)) {
        const Ray ray = maker.ray(beam, sub.u, sub.v);
        ASSERT_NEAR(ray.direction.norm(), 1, 1e-14);
        // The ray is evaluated where it crosses the plane at that range.
        const double t = (range - (ray.origin - axis.origin).dot(axis.direction)) /
                         ray.direction.dot(axis.direction);
        const Vec3 off = ray.at(t) - axis.at(range);
        right += double(sub.weight) * std::pow(off.dot(beam.right), 2);
        up += double(sub.weight) * std::pow(off.dot(beam.up), 2);
      }
      // the RMS of a uniform disc is half its radius
      EXPECT_NEAR(2 * std::sqrt(right), w, 0.005 * w);
      EXPECT_NEAR(2 * std::sqrt(up), h, 0.005 * h);
    }
  }
}

TEST(BeamShape, SigmaIsThatOfItsRandomRays) {
  const Ray axis{Vec3(1, 2, 3), unit_vector(0.7, -0.3)};
  const BeamAxes beam = beam_axes(axis);
  for (Profile profile : {Profile::kUniform, Profile::kGaussian, Profile::kTable}) {
    const BeamShape s = shape_of(profile);
    const double range = 12;
    Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
    const int n = 40000;
    for (int k = 0; k < n; ++k) {
      const Ray ray = random_ray(beam, s, beam_key(31, 0, uint64_t(k)));
      const double t = (range - (ray.origin - axis.origin).dot(axis.direction)) /
                       ray.direction.dot(axis.direction);
      const Vec3 off = ray.at(t) - axis.at(range);
      const Vec3 uv(off.dot(beam.right), off.dot(beam.up), 0);
      sum += uv / n;
      squares += uv.cwiseAbs2() / n;
    }
    const Vec3 sigma = (squares - sum.cwiseAbs2()).cwiseSqrt();
    const auto [horizontal, vertical] = s.sigma_m(range);
    EXPECT_NEAR(sigma.x(), horizontal, 0.02 * horizontal) << int(profile);
    EXPECT_NEAR(sigma.y(), vertical, 0.02 * vertical) << int(profile);
  }
}

TEST(RandomRay, FillsTheConeEvenlyAndTheEncodersStep) {
  BeamShape s = shape_of(Profile::kUniform);
  s.encoder_step_rad = 0.02;
  const Ray axis{Vec3::Zero(), unit_vector(0.4, 0.5)};
  const BeamAxes beam = beam_axes(axis);
  const int n = 40000;
  double azimuth = 0, azimuth2 = 0, up2 = 0;
  for (int k = 0; k < n; ++k) {
    const Ray ray = random_ray(beam, s, beam_key(9, 0, uint64_t(k)));
    const double a = std::atan2(ray.direction.y(), ray.direction.x()) - 0.4;
    azimuth += a / n;
    azimuth2 += a * a / n;
    up2 += std::pow(ray.direction.dot(beam.up), 2) / n;
    ASSERT_LE(ray.origin.norm(), 0.01 + 1e-12);
  }
  EXPECT_NEAR(azimuth, 0, 1e-4);
  const double spread = std::pow(0.002 / std::cos(0.5), 2) / 4;  // the width of the cone as azimuth
  EXPECT_NEAR(azimuth2, 0.02 * 0.02 / 12 + spread, 0.02 * azimuth2);
  EXPECT_NEAR(up2, 0.0005 * 0.0005 / 4, 0.02 * up2);

  s.encoder_step_rad = 0;
  for (Profile p : {Profile::kGaussian, Profile::kTable}) {
    s = shape_of(p);
    double left = 0, square = 0;
    for (int k = 0; k < n; ++k) {
      const Ray ray = random_ray(beam, s, beam_key(10, 0, uint64_t(k)));
      const double u = ray.direction.dot(beam.right) / ray.direction.dot(axis.direction) / 0.002;
      left += (u < -1.0 / 3) / double(n);
      square += u * u / n;
    }
    if (p == Profile::kTable) {
      EXPECT_NEAR(left, 3.0 / 7, 0.01);
    } else {
      EXPECT_NEAR(square, 1 / (2 * M_LN2), 0.02);
    }
  }
}

TEST(RandomRay, IsUniformOverTheDiscOfTheTruncatedCone) {
  // The test is χ² over rings × sectors of equal area of the disc that the cone cuts at 8 m.
  constexpr int kRings = 5, kSectors = 8, kRays = 40000;
  const BeamShape shape = round_beam(0.002, 0.0095);
  const BeamAxes beam = beam_axes({{1, 2, 3}, Vec3(0.8, 0, -0.6)});
  const double radius = 0.0095 / 2 + 8 * std::tan(0.001);
  std::vector<double> count(size_t(kRings) * kSectors);
  for (int k = 0; k < kRays; ++k) {
    const Ray ray = random_ray(beam, shape, beam_key(2024, 0, uint64_t(k)));
    const Vec3 from = ray.origin - beam.axis.origin;
    const double t = (8 - from.dot(beam.axis.direction)) / ray.direction.dot(beam.axis.direction);
    const Vec3 at = from + t * ray.direction;
    const double u = at.dot(beam.right) / radius, v = at.dot(beam.up) / radius;
    ASSERT_LE(u * u + v * v, 1 + 1e-9);
    const int ring = std::min(int((u * u + v * v) * kRings), kRings - 1);
    const int sector =
        std::min(int((std::atan2(v, u) / (2 * M_PI) + 0.5) * kSectors), kSectors - 1);
    ++count[size_t(ring) * kSectors + size_t(sector)];
  }
  double chi2 = 0;
  const double expected = double(kRays) / (kRings * kSectors);
  for (double c : count) chi2 += (c - expected) * (c - expected) / expected;
  EXPECT_LT(chi2, 72.1);  // 39 degrees of freedom: exceeded once in 1000
}

TEST(Beam, RefusesWhatIsNoShape) {
  BeamShape s = shape_of(Profile::kTable);
  EXPECT_NO_THROW(s.check());
  EXPECT_THROW(spread_sub_rays(s, 5), std::invalid_argument);
  s.table.push_back(1);
  EXPECT_THROW(s.check(), std::invalid_argument);
  s.table.assign(6, 0);
  EXPECT_THROW(s.check(), std::invalid_argument);
  s = shape_of(Profile::kUniform);
  s.divergence_rad[1] = -1;
  EXPECT_THROW(s.check(), std::invalid_argument);
  EXPECT_THROW(grid_sub_rays(s, 0, 3), std::invalid_argument);
  EXPECT_THROW(exact_weights(std::vector<double>{0, 0}), std::invalid_argument);
  // Straight up, any pair of perpendicular axes is correct.
  const BeamAxes beam = beam_axes({Vec3::Zero(), Vec3::UnitZ()});
  EXPECT_NEAR(beam.right.norm(), 1, 1e-15);
  EXPECT_NEAR(beam.right.dot(beam.up), 0, 1e-15);
}

}  // namespace
}  // namespace underbrush::sensor
