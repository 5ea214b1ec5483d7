// Cross-sensor transfer on a generated site: a model learnt from one lidar answers for another, and
// is held against the model that was learnt from that other lidar itself.
#include "study/transfer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "study/site_drive.hpp"
#include "study/studies.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::app {
namespace {

constexpr const char* kSensors[] = {"velodyne-hdl64e", "velodyne-vlp16"};
constexpr double kTolerance = 0.1;

/// One sensor's logs of the site.
struct SensorLogs {
  BeamLog train, test;
  double range_sigma_m = 0;
};

/// Elevations that all sensors see, rad.
struct Band {
  double low = -M_PI, high = M_PI;
};
Band common_band() {
  Band band;
  for (const char* name : kSensors) {
    double low = M_PI, high = -M_PI;
    for (const sensor::Channel& c : sensor::load(name).channels) {
      low = std::min(low, c.elevation_rad);
      high = std::max(high, c.elevation_rad);
    }
    band = {std::max(band.low, low), std::min(band.high, high)};
  }
  return band;
}

/// Of every 2 n scans the first trains and the middle one tests, n such that all sensors train on
/// about as many beams. Test beams outside `band` are left out: another sensor may never have
/// looked there.
SensorLogs drive_through(const std::string& name, const Band& band, const GeneratedSite& site,
                         uint64_t seed) {
  const sensor::Sensor sensor = sensor::load(name);
  double least = sensor.beams_per_s();
  for (const char* other : kSensors) least = std::min(least, sensor::load(other).beams_per_s());
  const auto half = uint32_t(std::lround(sensor.beams_per_s() / least));
  SiteDrive drive(site, sensor, seed);
  SensorLogs out;
  out.range_sigma_m = sensor.range_sigma_m;
  out.train.info = out.test.info = drive.info();
  BeamLog chunk;
  size_t done = 0;
  while (drive.next(chunk)) {
    BeamLog part[2] = {chunk.like(), chunk.like()};
    for (size_t i = 0; i < chunk.size(); ++i) {
      const double elevation = sensor.channels[chunk.ring[i]].elevation_rad;
      const bool shared = elevation >= band.low - 1e-9 && elevation <= band.high + 1e-9;
      const uint32_t phase = chunk.scan[i] % (2 * half);
      if (phase == 0) part[0].append(chunk, i);
      if (phase == half && shared) part[1].append(chunk, i);
    }
    for (int k = 0; k < 2; ++k) {
      drive.answer(done, part[k]);
      part[k].extra.clear();
      (k ? out.test : out.train).append(part[k], 0, part[k].size());
    }
    done += chunk.size();
  }
  return out;
}

metrics::Summary score_on(const elements::Model& model, const BeamLog& test, uint64_t seed) {
  const trace::World world(model);
  MemorySource real(test), like(test);
  simulate::Options options;
  options.seed = seed;
  simulate::SimulatedSource simulated(world, like, options);
  metrics::ScoreOptions what;
  what.world = &world;
  return metrics::score(real, simulated, what).all;
}

}  // namespace

std::vector<Check> transfer_checks(const std::string& from, const std::string& to,
                                   const metrics::Summary& transferred,
                                   const metrics::Summary& native) {
  const std::string what = fmt::format("{} to {}, ", from, to);
  return {{what + "F1 over the native one's", transferred.f1 / native.f1, 1 - kTolerance, false},
          {what + "cloud error over the native one's",
           transferred.cloud_error_m / native.cloud_error_m, 1 + kTolerance}};
}

StudyResult study_transfer(const StudyRun& run) {
  scene::SiteParameters parameters;
  parameters.seed = run.seed;
  parameters.terrain.size_x_m = run.quick ? 14 : 30;
  parameters.terrain.size_y_m = run.quick ? 14 : 30;
  parameters.trees = run.quick ? 3 : 12;
  parameters.shrubs = run.quick ? 8 : 40;
  const GeneratedSite site(parameters);
  const Band band = common_band();
  std::map<std::string, SensorLogs> logs;
  std::map<std::string, elements::Model> models;
  for (const char* name : kSensors) {
    logs[name] = drive_through(name, band, site, run.seed);
    run.say(fmt::format("{}: {} beams train, {} test", name, logs[name].train.size(),
                        logs[name].test.size()));
    fit::FitOptions options;
    options.seed = run.seed;
    MemorySource train(logs[name].train);
    models[name] = fit::fit(train, options).model;
  }
  StudyResult result;
  result.lead =
      "A generated site driven through with two lidars: each one's model answers the held-out "
      "beams "
      "of both. Nothing here was measured.";
  StudyTable table{"Cross-sensor transfer",
                   "Native: learnt from the sensor that is simulated. All train on about as many "
                   "beams; beams that test lie in the elevations that both sensors see.",
                   {"simulated ← learnt from", "F1", "point cloud error, m", "packet error, m",
                    "NLL/beam", "CRPS, m"},
                   {}};
  for (const char* to : kSensors) {
    std::map<std::string, metrics::Summary> scores;
    for (const char* from : kSensors) {
      const metrics::Summary s = scores[from] = score_on(models[from], logs[to].test, run.seed);
      table.rows.push_back(
          {fmt::format("{} ← {}", to, from), fmt::format("{:.4f}", s.f1),
           fmt::format("{:.4f}", s.cloud_error_m), fmt::format("{:.3f}", s.packet_error_m),
           fmt::format("{:.3f}", s.nll_per_beam), fmt::format("{:.3f}", s.crps_m)});
      result.figures[to][from] = {{"f1", s.f1},
                                  {"cloud_error_m", s.cloud_error_m},
                                  {"packet_error_m", s.packet_error_m},
                                  {"nll_per_beam", s.nll_per_beam},
                                  {"crps_m", s.crps_m}};
    }
    for (const char* from : kSensors) {
      if (from == to) continue;
      for (const Check& c : transfer_checks(from, to, scores[from], scores[to])) {
        result.checks.push_back(c);
      }
    }
  }
  result.tables.push_back(table);
  return result;
}

}  // namespace underbrush::app
