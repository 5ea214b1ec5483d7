// Counts allocations: perception allocates nothing in a cycle once it has seen as much as it will.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "clouds.hpp"
#include "underbrush/perception/alignment.hpp"
#include "underbrush/perception/false_positives.hpp"
#include "underbrush/perception/object_pipeline.hpp"
#include "underbrush/perception/occupancy_grid.hpp"
#include "underbrush/perception/output_delay.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace {
std::atomic<size_t> allocations{0};
}

// NOLINTBEGIN(misc-new-delete-overloads)
void* operator new(size_t n) {
  ++allocations;
  if (void* p = std::malloc(n ? n : 1)) return p;
  throw std::bad_alloc();
}
void* operator new(size_t n, std::align_val_t alignment) {
  ++allocations;
  const auto a = size_t(alignment);
  if (void* p = std::aligned_alloc(a, (n + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, size_t, std::align_val_t) noexcept { std::free(p); }
// NOLINTEND(misc-new-delete-overloads)

namespace underbrush::perception {
namespace {

// The scene of a cycle: cars that come near each other, are hidden now and then, and part.
struct Cycle {
  MergedCloud cloud;
  TruthFrame truth;
};

std::vector<Cycle> cycles() {
  std::vector<Cycle> all;
  for (int k = 0; k < 12; ++k) {
    const double t = 0.1 * k;
    Cycle cycle{test::empty_cloud(t), {t, {}}};
    test::add_ground(cycle.cloud, 20);
    for (uint64_t id = 1; id <= 4; ++id) {
      const double y = 2.2 * double(id) - 5 + 0.1 * std::sin(t * double(id));
      cycle.truth.objects.push_back(
          {id, ObjectClass::kCar, {{12, y, 0.75}, 0.1 * double(id), {4.5, 1.8, 1.5}}});
      if ((k + int(id)) % 6) test::add_box(cycle.cloud, cycle.truth.objects.back().box);
    }
    cycle.cloud.miss_m.assign(100, Vec3f(90, 10, 1));
    cycle.cloud.miss_sensor.assign(100, 0);
    all.push_back(cycle);
  }
  return all;
}

TEST(SteadyMemory, NoStageAllocatesAfterTheFirstCycles) {
  std::vector<Cycle> all = cycles();
  TrackingOptions options;
  options.resolution.enabled = true;
  TrackingModel model(options);
  ObjectPipeline pipeline;
  FalsePositives ghosts({.rate_per_s = 0.001});
  OccupancyGrid grid;
  OutputDelay delay;
  ObjectList list, other;
  double t = 0;
  const auto turn = [&](size_t k) {
    Cycle& cycle = all[k % all.size()];
    t += 0.1;
    cycle.cloud.time_s = cycle.cloud.available_s = cycle.truth.time_s = t;
    model.step(cycle.cloud, cycle.truth, list);
    ghosts.step(list);
    pipeline.step(cycle.cloud, other);
    grid.step(cycle.cloud);
    delay.push(list);
    return delay.at(t) ? delay.at(t)->objects.size() : 0;
  };
  for (size_t k = 0; k < 8 * all.size(); ++k) turn(k);
  const size_t before = allocations;
  size_t shown = 0;
  for (size_t k = 0; k < 2 * all.size(); ++k) shown += turn(k);
  EXPECT_EQ(allocations - before, 0u);
  EXPECT_GT(shown, 0u);
}

TEST(SteadyMemory, AlignmentAllocatesNothingAfterTheFirstCycles) {
  Alignment alignment(
      {"rig", {{"a", "ibeo-lux-2010", {}, 0, 0}, {"b", "ibeo-lux-2010", {}, 0, 0}}});
  std::vector<SensorCloud> clouds(2);
  for (uint16_t s = 0; s < 2; ++s) {
    clouds[s].sensor = s;
    for (int i = 0; i < 500; ++i) {
      clouds[s].point_m.emplace_back(i, s, 1);
      clouds[s].time_s.push_back(0.001 * i);
      clouds[s].intensity.push_back(1);
      clouds[s].ring.push_back(0);
    }
  }
  const Trajectory path({{0, {}}, {1, {Eigen::Quaterniond::Identity(), {5, 0, 0}}}});
  MergedCloud merged;
  alignment.merge(clouds, path, 0.5, merged);
  const size_t before = allocations;
  alignment.merge(clouds, path, 0.5, merged);
  EXPECT_EQ(allocations - before, 0u);
}

}  // namespace
}  // namespace underbrush::perception
