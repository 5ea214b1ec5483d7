// This study examines cross-sensor transfer on a generated site: a model learnt from one lidar
// simulates another, and is compared with the model learnt from that other lidar itself.
#include "studies/transfer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "studies/site_drive.hpp"
#include "studies/studies.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/metrics/look_up.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::studies {
namespace {

constexpr double kTolerance = 0.1;

/// Returns the lidars: three of the catalogue, and one of them with four times the divergence. The
/// quick study has two.
std::vector<sensor::Sensor> lidars(bool quick) {
  if (quick) return {sensor::load("velodyne-vlp16"), sensor::load("ouster-os1-64")};
  std::vector<sensor::Sensor> out{sensor::load("velodyne-hdl64e"), sensor::load("velodyne-vlp16"),
                                  sensor::load("ouster-os1-64"), sensor::load("velodyne-vlp16")};
  out.back().name += " of 4 x the divergence";
  for (double& width : out.back().beam.divergence_rad) width *= 4;
  return out;
}

/// The logs of the site from one sensor.
struct SensorLogs {
  BeamLog train, test;
  double range_sigma_m = 0;
};

/// Elevations (rad) that all sensors see.
struct Band {
  double low = -M_PI, high = M_PI;
};
Band common_band(const std::vector<sensor::Sensor>& sensors) {
  Band band;
  for (const sensor::Sensor& s : sensors) {
    double low = M_PI, high = -M_PI;
    for (const sensor::Channel& c : s.channels) {
      low = std::min(low, c.elevation_rad);
      high = std::max(high, c.elevation_rad);
    }
    band = {std::max(band.low, low), std::min(band.high, high)};
  }
  return band;
}

/// Drives through the site. Of every 2 · `half` scans the first is for training and the middle one
/// for testing. Test beams outside `band` are left out, since another sensor may never have looked
/// there.
SensorLogs drive_through(const sensor::Sensor& sensor, uint32_t half, const Band& band,
                         const GeneratedSite& site, uint64_t seed) {
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
  const pipeline::TracedWorld world(model);
  pipeline::SimulateOptions options;
  options.seed = seed;
  pipeline::Simulation simulation(world, options);
  const BeamLog answered = pipeline::simulate_log(simulation, test);
  MemorySource real(test), simulated(answered);
  return pipeline::score_log(real, simulated, &world).all;
}

// By the lidar that the model was learnt from.
using Scores = std::map<std::string, metrics::Summary>;

Scores scores_on(const std::map<std::string, elements::Model>& models, const BeamLog& test,
                 uint64_t seed) {
  Scores out;
  for (const auto& [from, model] : models) out[from] = score_on(model, test, seed);
  return out;
}

/// Scores the baselines on the held-out beams of a sensor. The look-up answers from the training
/// logs of each sensor, and always hit with the medians of the sensor's own rings.
Scores baselines_on(const std::map<std::string, SensorLogs>& logs, const std::string& to) {
  const SensorLogs& own = logs.at(to);
  const auto scored = [&](const BeamLog& answered) {
    MemorySource real(own.test), simulated(answered);
    return pipeline::score_log(real, simulated, nullptr).all;
  };
  Scores out;
  for (const auto& [from, learnt] : logs) {
    out["look-up, " + from] =
        scored(metrics::looked_up(learnt.train, own.test, metrics::LookUp::kWarped2));
  }
  out["always hit"] = scored(metrics::always_hit(own.train, own.test));
  return out;
}

/// A column of the table.
struct Figure {
  const char* name;
  const char* key;
  double metrics::Summary::*value;
  int digits;
};
constexpr Figure kFigures[] = {
    {"F1", "f1", &metrics::Summary::f1, 4},
    {"informedness", "informedness", &metrics::Summary::informedness, 3},
    {"point cloud error, m", "cloud_error_m", &metrics::Summary::cloud_error_m, 4},
    {"packet error, m", "packet_error_m", &metrics::Summary::packet_error_m, 3},
    {"NLL/beam", "nll_per_beam", &metrics::Summary::nll_per_beam, 3},
    {"CRPS, m", "crps_m", &metrics::Summary::crps_m, 3}};

report::Table empty_table(const char* title, const char* caption) {
  report::Table table{title, caption, {"simulated ← learnt from"}, {}};
  for (const Figure& f : kFigures) table.head.push_back(f.name);
  return table;
}

void add_rows(const std::string& to, const Scores& scores, report::Table& table, Json& figures) {
  for (const auto& [from, s] : scores) {
    table.rows.push_back({fmt::format("{} ← {}", to, from)});
    for (const Figure& f : kFigures) {
      const double value = s.*f.value;
      const bool known = std::isfinite(value);  // Baselines have no likelihood.
      table.rows.back().push_back(known ? fmt::format("{:.{}f}", value, f.digits) : "");
      figures[to][from][f.key] = known ? Json(value) : Json(nullptr);
    }
  }
}

/// Returns the beams of a log's rings of one parity.
BeamLog rings(const std::filesystem::path& file, int parity) {
  io::LogReader reader(file);
  BeamLog chunk, out;
  while (reader.next(chunk)) {
    if (out.empty()) out = chunk.like();
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.ring[i] % 2 == parity) out.append(chunk, i);
    }
  }
  return out;
}

/// Simulates the odd rings of real logs with a model learnt from the even ones, and with one learnt
/// from the odd ones: other elevations, but the same sensor. This is not part of the verdict.
void add_interlaced_logs(const StudyRun& run, StudyResult& result) {
  report::Table table = empty_table(
      "Every second ring of real logs",
      "No two sensors' logs of one place were given: rings of odd number stand for a second sensor "
      "of other elevations, of the same make. Half of each log trains, the other tests.");
  for (const std::filesystem::path& log : halved_logs(run.data)) {
    const std::string name = log.filename().string();
    run.say("rings of " + name);
    std::map<std::string, elements::Model> models;
    for (const int parity : {0, 1}) {
      const BeamLog beams = rings(log / "train.ply", parity);
      fit::FitOptions options;
      options.seed = run.seed;
      if (beams.info.scans.size() > 1) options.min_range_m = kVehicleM;
      MemorySource train(beams);
      models[parity ? "odd rings" : "even rings"] = pipeline::fit_model({train}, options).model;
    }
    add_rows(name + ", odd rings", scores_on(models, rings(log / "test.ply", 1), run.seed), table,
             result.figures);
    result.inputs.push_back(log / "train.ply");
    result.inputs.push_back(log / "test.ply");
  }
  if (!table.rows.empty()) result.tables.push_back(table);
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

StudyResult transfer(const StudyRun& run, const ModelChange& change) {
  test_site::SiteParameters parameters;
  parameters.seed = run.seed;
  parameters.terrain.size_x_m = run.quick ? 14 : 30;
  parameters.terrain.size_y_m = run.quick ? 14 : 30;
  parameters.trees = run.quick ? 3 : 12;
  parameters.shrubs = run.quick ? 8 : 40;
  const GeneratedSite site(parameters);
  const std::vector<sensor::Sensor> sensors = lidars(run.quick);
  const Band band = common_band(sensors);
  double least = INFINITY;  // Beams per second; all sensors train on about as many beams.
  for (const sensor::Sensor& s : sensors) least = std::min(least, s.beams_per_s());
  std::map<std::string, SensorLogs> logs;
  std::map<std::string, elements::Model> models;
  for (const sensor::Sensor& s : sensors) {
    const std::string& name = s.name;
    const auto half = uint32_t(std::lround(s.beams_per_s() / least));
    logs[name] = drive_through(s, half, band, site, run.seed);
    run.say(fmt::format("{}: {} beams train, {} test", name, logs[name].train.size(),
                        logs[name].test.size()));
    fit::FitOptions options;
    options.seed = run.seed;
    MemorySource train(logs[name].train);
    models[name] = pipeline::fit_model({train}, options).model;
    if (change) change(name, models[name]);
  }
  StudyResult result;
  result.lead =
      "A generated site driven through with four lidars: each one's model answers the held-out "
      "beams of all. Nothing there was measured.";
  report::Table table =
      empty_table("Cross-sensor transfer",
                  "Native: learnt from the sensor that is simulated. All train on "
                  "about as many beams; beams that test lie in the elevations that "
                  "all sensors see.");
  for (const auto& [to, beams] : logs) {
    const Scores scores = scores_on(models, beams.test, run.seed);
    add_rows(to, scores, table, result.figures);
    add_rows(to, baselines_on(logs, to), table, result.figures);
    for (const auto& [from, score] : scores) {
      if (from == to) continue;
      for (const Check& c : transfer_checks(from, to, score, scores.at(to))) {
        result.checks.push_back(c);
      }
    }
  }
  result.tables.push_back(table);
  if (!run.data.empty()) add_interlaced_logs(run, result);
  return result;
}

StudyResult study_transfer(const StudyRun& run) {
  require(run.keep.empty(), "study: transfer has nothing for --keep");
  return transfer(run, {});
}

}  // namespace underbrush::studies
