// Speed of the FMU's work on a SensorView of 200 000 reflections: decoding, each strategy, and
// encoding. The scene is generated. Reports medians of several runs.
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "programs.hpp"
#include "run.hpp"
#include "timing.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/osi/chain.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush::bench {
namespace {

osi::MovingObject car(uint64_t id, double x, double y) {
  osi::MovingObject m;
  m.id = id;
  m.type = 2;
  m.vehicle_type = 4;
  m.base.dimension_m = Vec3(4.6, 1.8, 1.5);
  m.base.position_m = Vec3(x, y, 0.75);
  m.base.roll_pitch_yaw = Vec3::Zero();
  m.centre_to_rear_m = Vec3(-1.4, 0, -0.45);
  return m;
}

/// A view with `beams` beams of `rays` rays, which all return, from a wall with cars before it. The
/// directions are in the first view of a run only.
std::string view_of(size_t beams, size_t rays, int k) {
  osi::SensorView v;
  v.version = osi::Version{};
  v.timestamp = osi::Timestamp::of(0.1 * (k + 1));
  v.host_vehicle_id = 0;
  v.truth.emplace();
  v.truth->moving.push_back(car(0, 0, 0));
  for (uint64_t n = 1; n <= 20; ++n) v.truth->moving.push_back(car(n, 20, 6 * double(n) - 63));
  osi::LidarSensorView& l = v.lidar.emplace_back();
  if (k == 0) {
    l.configuration.emplace();
    l.configuration->beams = uint32_t(beams);
  }
  Stream random(1);
  for (size_t b = 0; b < beams; ++b) {
    const double azimuth = random.uniform(-1.2, 1.2), elevation = random.uniform(-0.1, 0.1);
    for (size_t r = 0; r < rays; ++r) {
      const double a = azimuth + 1e-3 * random.uniform(), e = elevation + 1e-3 * random.uniform();
      const Vec3 d(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      const bool is_car = int(std::floor((20 * d.y() / d.x() + 63.9) / 1.8)) % 3 == 0;
      const double range = (is_car ? 17.7 : 40) / d.x();
      osi::Reflection f;
      f.time_of_flight_s = 2 * range / 299792458;
      f.signal_db = -10 - 20 * std::log10(range);
      if (is_car) f.object_id = 1;
      l.reflections.push_back(f);
      if (k == 0) l.configuration->directions.push_back(d.cast<float>());
    }
  }
  std::string bytes;
  osi::write(v, bytes);
  return bytes;
}

Json bench_chain(size_t beams, size_t rays, int runs) {
  osi::ChainFile file = osi::default_chain();
  file.set("front_end", "sensor", "ibeo-lux-2010");
  file.set("front_end", "max_range_m", "120");
  std::vector<std::pair<std::string, osi::Chain>> parts;
  for (const osi::StrategyEntry& e : file.strategies) {
    parts.emplace_back(e.name, osi::Chain(osi::ChainFile{{e}}));
  }
  std::map<std::string, std::vector<double>> times, cpu;
  size_t detections = 0, bytes = 0;
  for (int k = 0; k < runs + 2; ++k) {
    const std::string message = view_of(beams, rays, k);
    std::map<std::string, std::array<double, 2>> now;
    const auto timed = [&](const std::string& name, auto&& work) {
      const double before = cpu_seconds();
      const double ms = 1000 * seconds_of(work);
      now[name] = {ms, 1000 * (cpu_seconds() - before)};
    };
    osi::SensorData data;
    timed("decode", [&] {
      data = osi::begin_data(
          std::make_shared<osi::SensorView>(osi::read_sensor_view(std::string(message), "bench")));
    });
    for (auto& [name, chain] : parts) timed(name, [&, c = &chain] { c->step(data); });
    std::string out;
    timed("encode", [&] { osi::write(data, out); });
    if (k < 2) continue;  // The first one has the directions, and both reserve memory.
    std::array<double, 2> all{};
    for (const auto& [name, ms] : now) {
      times[name].push_back(ms[0]);
      cpu[name].push_back(ms[1]);
      for (size_t i = 0; i < all.size(); ++i) all[i] += ms[i];
    }
    times["all"].push_back(all[0]);
    cpu["all"].push_back(all[1]);
    detections = data.lidar.at(0).detections.size();
    bytes = message.size();
  }
  Json j;
  j["beams"] = beams;
  j["rays_a_beam"] = rays;
  j["reflections"] = beams * rays;
  j["bytes"] = bytes;
  j["detections"] = detections;
  for (const auto& [name, ms] : times) j["ms"][name] = median(ms);
  for (const auto& [name, ms] : cpu) j["cpu_ms"][name] = median(ms);
  return j;
}

}  // namespace

int bench_fmu(int argc, char** argv) {
  return run(argc, argv, "Speed of the FMU's work on a SensorView", 20, [](int runs) {
    Json j;
    j["threads"] = underbrush::threads();
    j["super_sampled"] = bench_chain(542, 369, runs);  // 9 × 41 sub-rays
    j["thin_rays"] = bench_chain(200000, 1, runs);
    return j;
  });
}

}  // namespace underbrush::bench
