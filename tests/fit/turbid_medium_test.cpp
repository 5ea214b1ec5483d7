/// Matter of known density, as the field's estimators assume it: a slab of leaves much smaller than
/// the distances between them, which intercept beams as a Poisson process does.
#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/rasters/canopy.hpp"

namespace underbrush::fit {
namespace {

constexpr double kBottomM = 3, kTopM = 9, kHalfM = 15, kMaxM = 50;

/// Draws the end of a beam in a slab of leaves of all directions alike, above flat ground.
double end_of(const Ray& ray, double leaf_area_density, Stream& random) {
  const double ground = ray.direction.z() < 0 ? -ray.origin.z() / ray.direction.z() : HUGE_VAL;
  double enter = 0, leave = HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    const double low = k == 2 ? kBottomM : -kHalfM, high = k == 2 ? kTopM : kHalfM;
    const double a = (low - ray.origin[k]) / ray.direction[k];
    const double b = (high - ray.origin[k]) / ray.direction[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  const double free = -std::log1p(-random.uniform()) / (0.5 * leaf_area_density);
  return std::min(enter + free < leave ? enter + free : HUGE_VAL, ground);
}

/// The log of five tripods, whose beams have all directions above 45° below the horizon alike.
BeamLog log_of_slab(double leaf_area_density, size_t beams) {
  BeamLog log;
  log.info.min_range_m = 0.1;
  log.info.max_range_m = kMaxM;
  log.info.has_misses = true;
  log.resize(beams);
  Stream random(41);
  for (size_t i = 0; i < beams; ++i) {
    const size_t tripod = i * 5 / beams;
    const double z = random.uniform(-0.7, 1), azimuth = random.uniform(0, 2 * M_PI);
    const double flat = std::sqrt(1 - z * z);
    log.origin[i] = Vec3(tripod % 2 ? 5 : -5, tripod < 2 ? 5 : -5, 1.5);
    if (tripod == 4) log.origin[i] = Vec3(0, 0, 1.5);
    log.direction[i] = Vec3(flat * std::cos(azimuth), flat * std::sin(azimuth), z).cast<float>();
    log.scan[i] = uint32_t(tripod);
    log.time_s[i] = 60 * double(tripod) + 1e-4 * double(i);
    const double end = end_of(log.ray(i), leaf_area_density, random);
    log.range_m[i] = end < kMaxM ? float(end + 0.01 * random.normal()) : kMiss;
  }
  return log;
}

/// The share of beams from straight above that the elements of a model let pass to the ground.
double share_passed(const elements::Model& model) {
  const trace::World world(model);
  Stream random(42);
  double sum = 0;
  constexpr int kBeams = 4000;
  std::vector<Ray> rays;
  rays.reserve(kBeams);
  for (int k = 0; k < kBeams; ++k) {
    rays.push_back({Vec3(random.uniform(-5, 5), random.uniform(-5, 5), 20), -Vec3::UnitZ()});
  }
  const std::vector<double> reach(rays.size(), 19.9);
  trace::IntersectionLists met;
  world.all_intersections(rays, {0, 30}, reach, met, trace::World::Sequence::kAny);
  for (size_t k = 0; k < rays.size(); ++k) {
    double through = 1;
    for (const trace::Intersection& m : met[k]) {
      if (m.t_m < 19.5) through *= 1 - m.p;
    }
    sum += through;
  }
  return sum / kBeams;
}

TEST(TurbidMedium, ComesBackWithItsDensityAtEveryHeightAndFromAbove) {
  for (const double density : {0.2, 0.5, 1.0}) {
    const BeamLog log = log_of_slab(density, 200000);
    MemorySource source(log);
    FitOptions options;
    options.range_noise_m = 0.01;
    const FitResult r = fit(source, options);
    elements::Scene scene;
    scene.models = {r.model};
    scene.instances.resize(1);
    scene.instances[0].world_from_model.translation = r.model.origin;
    const rasters::Canopy c = rasters::canopy_of(scene, trace::World(r.model));
    double all = 0, layers = 0;
    for (uint32_t k = 0; k < c.size[2]; ++k) {
      const double z = c.low.z() + k + 0.5;
      if (z < kBottomM + 1 || z > kTopM - 1) continue;
      double sum = 0, cells = 0;
      for (uint32_t j = 0; j < c.size[1]; ++j) {
        for (uint32_t i = 0; i < c.size[0]; ++i) {
          const Vec3 at = c.low + Vec3(i + 0.5, j + 0.5, 0);
          if (std::abs(at.x()) > 6 || std::abs(at.y()) > 6) continue;
          sum += double(c.area_density[(k * c.size[1] + j) * c.size[0] + i]);
          ++cells;
        }
      }
      EXPECT_NEAR(sum / cells / density, 1, 0.1) << density << " at " << z << " m";
      all += sum / cells / density;
      ++layers;
    }
    EXPECT_NEAR(all / layers, 1, 0.05) << density;
    const double passed = std::exp(-0.5 * density * (kTopM - kBottomM));
    EXPECT_NEAR(share_passed(r.model) / passed, 1, 0.12) << density;
  }
}

}  // namespace
}  // namespace underbrush::fit
