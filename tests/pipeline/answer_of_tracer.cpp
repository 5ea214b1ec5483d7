/// Traces the rays of a sensor from where the scans of a log began, as the FMU and `osi replay` do,
/// and answers the same rays by `Simulation`. Prints how many there are, how many return, how many
/// of the two answers differ, and the farthest difference and the root mean square one (m) where
/// both return:
///   answer_of_tracer MODEL SENSOR LOG SEED
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/chain.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/radiometry/response.hpp"

namespace {

using namespace underbrush;

osi::SensorView view_at(const Vec3& position, double time_s) {
  osi::SensorView v;
  v.version = osi::Version{};
  v.timestamp = osi::Timestamp::of(time_s);
  v.sensor_id = v.host_vehicle_id = 1;
  osi::MovingObject host;
  host.id = 1;
  host.type = uint32_t(osi::ObjectType::kVehicle);
  host.base.position_m = position;
  host.base.dimension_m = Vec3(4.6, 1.8, 1.5);
  v.truth.emplace();
  v.truth->timestamp = v.timestamp;
  v.truth->moving = {host};
  return v;
}

void append(const osi::SensorView& view, uint32_t scan, BeamLog& log) {
  const osi::LidarSensorView& lidar = view.lidar.at(0);
  for (size_t i = 0; i < lidar.reflections.size(); ++i) {
    const osi::Reflection& f = lidar.reflections[i];
    const size_t row = log.size();
    log.resize(row + 1);
    log.origin[row] = *view.host()->base.position_m;
    log.direction[row] = lidar.configuration->directions[i];
    log.time_s[row] = view.timestamp->s();
    log.scan[row] = scan;
    if (!f.is_miss()) log.range_m[row] = float(f.time_of_flight_s * radiometry::kSpeedOfLight / 2);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  try {
    osi::ChainFile file;
    file.strategies.push_back({"tracer", "", {}, "", "tracer"});
    file.set("tracer", "world", argv[1]);
    file.set("tracer", "sensor", argv[2]);
    file.set("tracer", "seed", argv[4]);
    file.set("tracer", "columns", "1");
    file.set("tracer", "rows", "1");
    osi::Chain chain(file);
    BeamLog traced;
    const io::LogReader log(argv[3]);
    traced.info.min_range_m = log.info().min_range_m;
    traced.info.max_range_m = log.info().max_range_m;
    for (const ScanInfo& scan : log.info().scans) {
      const auto view = std::make_shared<const osi::SensorView>(
          view_at(scan.world_from_sensor.translation, scan.time_s));
      append(*chain.step(view).views.at(0), scan.scan, traced);
    }
    pipeline::SimulateOptions options;
    options.seed = std::stoull(argv[4]);
    const pipeline::TracedWorld world(pipeline::read_world(argv[1]), pipeline::matter_of(options));
    BeamLog simulated = traced;
    pipeline::Simulation(world, options).answer(0, simulated);
    size_t returns = 0, both = 0, other = 0;
    double farthest = 0, squares = 0;
    for (size_t i = 0; i < traced.size(); ++i) {
      returns += traced.is_hit(i);
      other += traced.range_m[i] != simulated.range_m[i];
      if (!traced.is_hit(i) || !simulated.is_hit(i)) continue;
      const double off = std::abs(double(traced.range_m[i]) - double(simulated.range_m[i]));
      farthest = std::max(farthest, off);
      squares += off * off;
      ++both;
    }
    std::printf(
        R"({"rays": %zu, "returns": %zu, "both": %zu, "other": %zu, "farthest_m": %g, "rms_m": %g})",
        traced.size(), returns, both, other, farthest, std::sqrt(squares / double(both)));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
