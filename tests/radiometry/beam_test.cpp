// Tests of a whole beam on simple shapes, against closed forms.
#include "underbrush/sensor/beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "underbrush/radiometry/receiver.hpp"

namespace underbrush::radiometry {
namespace {

using sensor::BeamShape;
using sensor::SubRay;

constexpr double kSignal = 1e7;  // at 1 m

/// The returns of the sub-rays of a beam along +x from a surface. `meet(ray)` gives the range (or
/// infinity) and the cosine of the incidence.
struct Shot {
  std::vector<float> range, weight, factor;
  Echoes echoes;
};
template <class F>
Shot shoot(const BeamShape& shape, const std::vector<SubRay>& places, F meet) {
  Shot shot;
  const sensor::BeamAxes beam = sensor::beam_axes(Ray{});
  const sensor::RayMaker maker(shape);
  for (const SubRay& place : places) {
    const auto [range, cosine] = meet(maker.ray(beam, place.u, place.v));
    shot.range.push_back(float(range));
    shot.weight.push_back(place.weight);
    shot.factor.push_back(float(cosine));
  }
  ReceiverOptions options;
  options.noise_sigma = 0;
  options.signal_at_1m = kSignal;
  options.mode = ReturnMode::kAll;
  options.max_echoes = 8;
  const Receiver receiver(options);
  Waveform scratch = receiver.scratch();
  std::vector<float> signal(shot.range.size());
  shot.echoes = receiver.receive(shot.range, shot.weight, shot.factor, signal, 1, scratch);
  return shot;
}

/// Makes the plane through (distance, 0, 0) with this normal.
auto plane(double distance, const Vec3& normal) {
  return [=](const Ray& ray) {
    const double cosine = -ray.direction.dot(normal);
    const double t = (ray.origin - Vec3(distance, 0, 0)).dot(normal) / cosine;
    return cosine > 0 && t > 0 ? std::pair(t, cosine) : std::pair(double(INFINITY), 0.0);
  };
}

BeamShape beam_of(double divergence_rad, double exit_m) {
  return sensor::round_beam(divergence_rad, exit_m);
}

TEST(Beam, PlaneAtAnyAngleHasItsRangeItsCosineAndAStretchedPulse) {
  const BeamShape shape = beam_of(0.003, 0.01);
  const auto places = sensor::spread_sub_rays(shape, 400);
  const double sigma = kSpeedOfLight / 2 * 5e-9 / std::sqrt(8 * M_LN2);
  for (const double distance : {10.0, 40.0, 100.0}) {
    for (const double degrees : {0.0, 20.0, 45.0, 60.0, 75.0, 80.0}) {
      const double angle = degrees * M_PI / 180;
      const Shot shot =
          shoot(shape, places, plane(distance, Vec3(-std::cos(angle), std::sin(angle), 0)));
      ASSERT_EQ(shot.echoes.count, 1) << distance << " m, " << degrees;
      const Echo& e = shot.echoes.echo[0];
      // To second order of the footprint, the far side is larger and dimmer.
      // on the plane it is stretched by the tangent
      const double width = shape.half_width_m(distance)[0];
      const double variance = std::pow(width * std::tan(angle) / 2, 2);  // of the ranges
      EXPECT_NEAR(e.range_m, distance, 2e-3 + 8 * variance / distance);
      const double energy = kSignal * std::cos(angle) / (distance * distance);
      EXPECT_NEAR(e.energy, energy, 0.01 * energy) << distance << " m, " << degrees;
      // The reference is the peak of a Gaussian blurred by the footprint's ranges, as if these were
      // Gaussian.
      const double blurred = std::sqrt(sigma * sigma + variance);
      EXPECT_NEAR(e.peak / e.energy, sigma / blurred, 0.12 * sigma / blurred);
    }
  }
}

// For a sphere of radius a in a parallel beam of half-width w ≥ a, ∫ cos dA over the disc is ⅔ π
// a².
TEST(Beam, SphereSendsTwoThirdsOfTheLightThatMeetsIt) {
  const BeamShape shape = beam_of(0, 0.8);
  const auto places = sensor::spread_sub_rays(shape, 20000);
  for (const double radius : {0.1, 0.2, 0.4}) {
    const double distance = 30;  // to its front
    const Shot shot = shoot(shape, places, [&](const Ray& ray) {
      const Vec3 centre(distance + radius, 0, 0);
      const double t = (centre - ray.origin).dot(ray.direction);
      const double off2 = (ray.at(t) - centre).squaredNorm();
      if (off2 > radius * radius) return std::pair(double(INFINITY), 0.0);
      const double inside = std::sqrt(radius * radius - off2);
      return std::pair(t - inside, inside / radius);
    });
    ASSERT_EQ(shot.echoes.count, 1);
    const double share = 2.0 / 3 * radius * radius / (0.4 * 0.4);
    const double energy = kSignal * share / std::pow(distance, 2);
    EXPECT_NEAR(shot.echoes.echo[0].energy, energy, 0.03 * energy) << radius;
    // With c the cosine, the depth is a(1−c) and the weight c · 2c dc, so that the mean depth is ¼
    // a.
    EXPECT_NEAR(shot.echoes.echo[0].range_m, distance + radius / 4, 3e-3 + 0.02 * radius);
  }
}

TEST(Beam, StepOfTwoSurfacesSharesTheEnergyAsTheyShareTheFootprint) {
  const BeamShape shape = beam_of(0.003, 0.01);
  const auto grid = sensor::grid_sub_rays(shape, 41, 41);
  for (const double edge : {-0.5, 0.0, 0.3}) {  // in half-widths of the footprint
    for (const double depth : {0.15, 3.0}) {
      const double near = 50, at = edge * shape.half_width_m(near)[0];
      const Shot shot = shoot(shape, grid, [&](const Ray& ray) {
        const double t = near / ray.direction.x();
        return std::pair(ray.at(t).y() < at ? t : (near + depth) / ray.direction.x(), 1.0);
      });
      // The share is that of a disc's area on one side of a chord; u points right, to −y.
      const double share = 1 - (std::acos(edge) - edge * std::sqrt(1 - edge * edge)) / M_PI;
      const double a = kSignal * share / (near * near);
      const double b = kSignal * (1 - share) / std::pow(near + depth, 2);
      if (depth > 1) {
        ASSERT_EQ(shot.echoes.count, 2) << edge;
        EXPECT_NEAR(shot.echoes.echo[0].range_m, near, 3e-3);
        EXPECT_NEAR(shot.echoes.echo[1].range_m, near + depth, 3e-3);
        EXPECT_NEAR(shot.echoes.echo[0].energy, a, 0.04 * a);
        EXPECT_NEAR(shot.echoes.echo[1].energy, b, 0.04 * b);
        EXPECT_NEAR(shot.echoes.echo[0].energy + shot.echoes.echo[1].energy, a + b, 0.005 * a);
      } else {
        ASSERT_EQ(shot.echoes.count, 1) << edge;  // a mixed pixel, between the surfaces
        EXPECT_NEAR(shot.echoes.echo[0].range_m, (near * a + (near + depth) * b) / (a + b), 8e-3);
        EXPECT_NEAR(shot.echoes.echo[0].energy, a + b, 0.01 * (a + b));
      }
    }
  }
}

// However a beam is divided into sub-rays, a surface that takes all of its light returns all of it,
// and a surface that takes a part returns that part.
TEST(Beam, EnergyIsConservedOverSubRays) {
  for (const auto profile : {sensor::Profile::kUniform, sensor::Profile::kGaussian}) {
    BeamShape shape = beam_of(0.002, 0.01);
    shape.profile = profile;
    for (const auto& places :
         {sensor::spread_sub_rays(shape, 1), sensor::spread_sub_rays(shape, 41),
          sensor::grid_sub_rays(shape, 9, 41), sensor::grid_sub_rays(shape, 3, 3)}) {
      const Shot shot = shoot(shape, places, plane(50, Vec3(-1, 0, 0)));
      EXPECT_EQ(std::accumulate(shot.weight.begin(), shot.weight.end(), 0.0f), 1);
      ASSERT_EQ(shot.echoes.count, 1);
      EXPECT_NEAR(shot.echoes.echo[0].energy, kSignal / 2500, 1e-3 * kSignal / 2500);
    }
  }
}

// A target smaller than the beam returns the share of the footprint that it fills. Beyond the range
// where it fills the footprint, power falls as R⁻⁴.
TEST(Beam, SmallTargetFadesWithTheFourthPowerOfTheRange) {
  const BeamShape shape = beam_of(0.01, 0);
  const auto places = sensor::spread_sub_rays(shape, 20000);
  for (const double distance : {15.0, 30.0, 60.0, 110.0}) {
    const double side = 0.1;
    const Shot shot = shoot(shape, places, [&](const Ray& ray) {
      const double t = distance / ray.direction.x();
      const Vec3 p = ray.at(t);
      const bool hit = std::abs(p.y()) < side / 2 && std::abs(p.z()) < side / 2;
      return std::pair(hit ? t : double(INFINITY), 1.0);
    });
    ASSERT_EQ(shot.echoes.count, 1);
    const double footprint = M_PI * std::pow(distance * std::tan(0.005), 2);
    const double energy = kSignal * side * side / footprint / (distance * distance);
    EXPECT_NEAR(shot.echoes.echo[0].energy, energy, 0.05 * energy + 0.02) << distance;
  }
}

}  // namespace
}  // namespace underbrush::radiometry
