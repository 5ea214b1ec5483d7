// Cross-sensor transfer on a generated site: a model learnt from one lidar answers for another, and
// is held against the model that was learnt from that other lidar itself.
#include "study/transfer.hpp"

#include <fmt/format.h>

#include <map>

#include "study/studies.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/scene/test_site.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/footprint.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::app {
namespace {

constexpr const char* kSensors[] = {"velodyne-hdl64e", "velodyne-vlp16"};
constexpr double kTolerance = 0.1;

/// One sensor's logs of the site: of every four scans the first trains, the third tests.
struct SensorLogs {
  BeamLog train, test;
  double range_sigma_m = 0;
};

SensorLogs drive_through(const std::string& name, const scene::Site& site,
                         const scene::FlatSite& flat, const trace::World& world, uint64_t seed) {
  constexpr uint32_t kEvery = 4, kTest = 2;
  const sensor::Sensor sensor = sensor::load(name);
  const auto& poses = site.world_from_sensor.poses();
  sensor::PatternSource pattern(sensor, site.world_from_sensor, poses.front().time_s,
                                poses.back().time_s, 1 << 18);
  simulate::FootprintOptions beam;
  beam.seed = seed;
  beam.shape = sensor.beam;
  beam.range_sigma_m = sensor.range_sigma_m;
  SensorLogs out;
  out.range_sigma_m = sensor.range_sigma_m;
  out.train.info = pattern.info();
  out.train.info.has_misses = true;
  out.test.info = out.train.info;
  BeamLog chunk;
  size_t done = 0;
  while (pattern.next(chunk)) {
    BeamLog wanted = chunk.like();
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.scan[i] % kEvery == 0 || chunk.scan[i] % kEvery == kTest) wanted.append(chunk, i);
    }
    simulate::scan(world, flat.label, beam, done, wanted);
    wanted.extra.clear();
    for (size_t i = 0; i < wanted.size(); ++i) {
      (wanted.scan[i] % kEvery == 0 ? out.train : out.test).append(wanted, i);
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
  const scene::Site site = scene::make_site(parameters);
  const scene::FlatSite flat = scene::flatten(site);
  const trace::World world(flat.model);
  std::map<std::string, SensorLogs> logs;
  std::map<std::string, elements::Model> models;
  for (const char* name : kSensors) {
    logs[name] = drive_through(name, site, flat, world, run.seed);
    run.say(fmt::format("{}: {} beams train, {} test", name, logs[name].train.size(),
                        logs[name].test.size()));
    fit::FitOptions options;
    options.seed = run.seed;
    options.credit.rule = "best";
    options.range_noise_m = logs[name].range_sigma_m;
    MemorySource train(logs[name].train);
    models[name] = fit::fit(train, options).model;
  }
  StudyResult result;
  result.lead =
      "A generated site driven through with two lidars: each one's model answers the held-out "
      "beams "
      "of both. Nothing here was measured.";
  StudyTable table{"Cross-sensor transfer",
                   "Native: learnt from the sensor that is simulated.",
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
