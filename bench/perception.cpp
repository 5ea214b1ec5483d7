// Speed of the stages of perception on 200 cars with 100 000 points, and of the intersection of
// [rosenberger20] figure 11 with two Ibeo LUX 2010 of 9 × 41 sub-rays, from the scene to the lists.
// The scenes are generated. Reports medians of several runs.
#include <cmath>
#include <nlohmann/json.hpp>

#include "programs.hpp"
#include "run.hpp"
#include "studies/intersection.hpp"
#include "timing.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/perception/object_pipeline.hpp"
#include "underbrush/perception/occupancy_grid.hpp"
#include "underbrush/perception/perceive.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace underbrush::bench {
namespace {

/// Cars on a square grid around the vehicle, each with as many points on the sides that it shows.
void make_crowd(size_t objects, size_t points, perception::MergedCloud& cloud,
                perception::TruthFrame& truth) {
  Stream random(1);
  cloud.sensor_m = {Vec3f(0, 0, 1.8f)};
  const auto side = size_t(std::ceil(std::sqrt(double(objects))));
  for (size_t k = 0; k < objects; ++k) {
    const double x = (double(k % side) - double(side) / 2 + 0.5) * 8;
    const double y = (double(k / side) - double(side) / 2 + 0.5) * 8;
    const double yaw = random.uniform(-M_PI, M_PI);
    const perception::OrientedBox box{{x, y, 0.75}, yaw, {4.5, 1.8, 1.5}};
    truth.objects.push_back({k + 1, perception::ObjectClass::kCar, box});
    const Vec3 view = box.to_box({0, 0, 1.8});
    for (size_t i = 0; i < points / objects; ++i) {
      const double along = random.uniform(-1, 1), z = random.uniform(-0.4, 0.75);
      const bool is_long = random.uniform() < 4.5 / 6.3;
      const Vec3 p = is_long ? Vec3(2.25 * along, view.y() > 0 ? 0.9 : -0.9, z)
                             : Vec3(view.x() > 0 ? 2.25 : -2.25, 0.9 * along, z);
      cloud.point_m.push_back(box.from_box(p).cast<float>());
      cloud.stamp_s.push_back(0);
      cloud.intensity.push_back(1);
      cloud.ring.push_back(0);
      cloud.sensor.push_back(0);
    }
  }
}

// The median time of a step, after a few that reserve the memory. The stages use one thread, so the
// time of the processor is that of a machine without other work.
template <class F>
Json step_times(int runs, F step) {
  std::vector<double> times, cpu;
  for (int k = 0; k < runs + 3; ++k) {
    const double before = cpu_seconds();
    const double t = seconds_of([&] { step(0.1 * k); });
    if (k < 3) continue;
    times.push_back(1000 * t);
    cpu.push_back(1000 * (cpu_seconds() - before));
  }
  return {{"ms", median(times)}, {"cpu_ms", median(cpu)}};
}

Json bench_stages(size_t objects, size_t points, int runs) {
  perception::MergedCloud cloud;
  perception::TruthFrame truth;
  make_crowd(objects, points, cloud, truth);
  perception::TrackingModel model;
  perception::ObjectPipeline pipeline;
  perception::OccupancyGrid grid;
  perception::ObjectList list;
  const auto at = [&](double t) { cloud.time_s = cloud.available_s = truth.time_s = t; };
  Json j;
  j["objects"] = objects;
  j["points"] = cloud.size();
  j["model"] = step_times(runs, [&](double t) {
    at(t);
    model.step(cloud, truth, list);
  });
  j["listed"] = list.objects.size();
  j["pipeline"] = step_times(runs, [&](double t) {
    at(t);
    pipeline.step(cloud, list);
  });
  j["grid"] = step_times(runs, [&](double) { grid.step(cloud); });
  return j;
}

Json bench_intersection(int runs) {
  const studies::Intersection scene = studies::make_intersection();
  const perception::LogTruth truth(scene.truth);
  perception::PerceptionSetup setup;
  setup.rig = scene.rig;
  std::vector<double> scan, lists, cpu;
  size_t rows = 0;
  for (int k = 0; k < runs; ++k) {
    const double before = cpu_seconds();
    BeamLog log;
    scan.push_back(seconds_of([&] { log = studies::scan_intersection(scene, 9, 41, 1); }));
    MemorySource source(log);
    lists.push_back(seconds_of([&] { perception::perceived(source, &truth, setup); }));
    cpu.push_back(cpu_seconds() - before);
    rows = log.size();
  }
  const double all = median(scan) + median(lists);
  return {{"seconds", studies::kIntersectionS},
          {"rows", rows},
          {"scan_s", median(scan)},
          {"lists_s", median(lists)},
          {"cpu_s", median(cpu)},
          {"times_real_time", studies::kIntersectionS / all}};
}

}  // namespace

int bench_perception(int argc, char** argv) {
  return run(argc, argv, "Speed of perception", 5, [](int runs) {
    Json j = bench_stages(200, 100000, 10 * runs);
    j["threads"] = underbrush::threads();
    j["intersection"] = bench_intersection(runs);
    return j;
  });
}

}  // namespace underbrush::bench
