/// \file
/// The generated site as a log, for benchmarks without a file.
#pragma once
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/footprint.hpp"
#include "underbrush/test_site/test_site.hpp"

namespace underbrush::bench {

/// The generated site, scanned by a Velodyne HDL-64E for `seconds`.
inline BeamLog scanned_site(double seconds) {
  const test_site::Site site = test_site::make_site({});
  const test_site::FlatSite flat = test_site::flatten(site);
  const trace::World world(flat.model);
  const double start = site.world_from_sensor.poses().front().time_s;
  BeamLog log = sensor::beams(sensor::load("velodyne-hdl64e"), site.world_from_sensor, start,
                              start + seconds);
  log.info.has_misses = true;
  simulate::scan(world, flat.label, {}, 0, log);
  return log;
}

}  // namespace underbrush::bench
