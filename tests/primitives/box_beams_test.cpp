#include "underbrush/primitives/box_beams.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "primitives/sites.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::primitives {
namespace {

constexpr double kDensity[3] = {0.2, 0.05, 0.6};  // 1/m, by thirds

/// A turned box of matter, and a log of beams that end in it at random. Some end at another object
/// in front of it or within it, some have no return.
struct Scene {
  PlacedObject object;
  BeamLog log;
};

double density_at(const PlacedObject& o, const Vec3& in_object) {
  if ((in_object - o.box.min).minCoeff() < 0 || (o.box.max - in_object).minCoeff() < 0) return 0;
  const double up = (in_object.z() - o.box.min.z()) / o.box.size().z();
  return kDensity[std::min(2, int(3 * up))];
}

Scene scene(uint64_t seed, size_t beams) {
  Stream random(seed);
  Scene out;
  PlacedObject& o = out.object;
  o.position = Vec3(103, -51, 7);
  o.yaw_rad = 0.6;
  o.box = {Vec3(-4, -2, 0), Vec3(3, 2, 6)};
  o.instance = 5;
  BeamLog& log = out.log;
  log.info.classes = "underbrush";
  log.info.has_misses = true;
  log.info.max_range_m = 60;
  log.resize(beams);
  std::vector<uint8_t> label(beams, uint8_t(elements::Class::kSmallTree));
  std::vector<uint32_t> instance(beams, 0);
  const Pose object_from_world = o.world_from_object().inverse();
  for (size_t i = 0; i < beams; ++i) {
    const double a = random.uniform(0, 2 * M_PI);
    log.origin[i] = o.position + Vec3(20 * std::cos(a), 20 * std::sin(a), random.uniform(0, 9));
    const double x = random.uniform(-4, 4), y = random.uniform(-4, 4), z = random.uniform(0, 6);
    const Vec3 d = (o.position + Vec3(x, y, z) - log.origin[i]).normalized();
    log.direction[i] = d.cast<float>();
    const double stop_m = random.uniform() < 0.3 ? random.uniform(5, 40) : 1e9;
    const double step_m = 0.02;
    for (double t = step_m / 2; t < std::min(60.0, stop_m); t += step_m) {
      const double rho = density_at(o, object_from_world * (log.origin[i] + t * d));
      if (rho > 0 && random.uniform() < rho * step_m) {
        log.range_m[i] = float(t);
        instance[i] = o.instance;
        break;
      }
    }
    if (!log.is_hit(i) && stop_m < 60) log.range_m[i] = float(stop_m), instance[i] = i % 2 ? 9 : 0;
  }
  log.extra["class"] = label;
  log.extra["instance"] = instance;
  return out;
}

TEST(BoxBeams, ReturnsPerMetreAreTheDensityWhateverStandsElsewhere) {
  const Scene s = scene(1, 4000);
  MemorySource source(s.log);
  PlacedObject other = s.object;  // Its box overlaps, and few beams end at it.
  other.instance = 9;
  std::vector<PlacedObject> objects{s.object, other};
  measure_beams(source, objects);
  const BoxBeams& b = objects[0].beams;
  ASSERT_TRUE(b.known());
  for (size_t t = 0; t < 3; ++t) {
    ASSERT_GT(b.returns[t], 100);
    const double density = b.returns[t] / b.path_m[t];
    EXPECT_NEAR(density, kDensity[t], 4 * density / std::sqrt(b.returns[t]));
    EXPECT_EQ(objects[1].beams.path_m[t], b.path_m[t]);
    EXPECT_LT(objects[1].beams.returns[t], b.returns[t]);
  }
  const auto& instance = std::get<std::vector<uint32_t>>(s.log.extra.at("instance"));
  EXPECT_EQ(std::accumulate(b.returns.begin(), b.returns.end(), 0.0),
            double(std::count(instance.begin(), instance.end(), s.object.instance)));
}

TEST(BoxBeams, DoNotDependOnThreadsOrChunks) {
  const Scene s = scene(2, 1500);
  std::vector<PlacedObject> one{s.object}, many{s.object};
  set_threads(1);
  MemorySource whole(s.log);
  measure_beams(whole, one);
  set_threads(0);
  MemorySource chunks(s.log, 700);
  measure_beams(chunks, many);
  EXPECT_EQ(one[0].beams.returns, many[0].beams.returns);
  EXPECT_EQ(one[0].beams.path_m, many[0].beams.path_m);
}

TEST(BoxBeams, AreUnknownWithoutMisses) {
  Scene s = scene(3, 100);
  s.log.info.has_misses = false;
  MemorySource source(s.log);
  std::vector<PlacedObject> objects{s.object};
  measure_beams(source, objects);
  EXPECT_FALSE(objects[0].beams.known());
}

}  // namespace
}  // namespace underbrush::primitives
