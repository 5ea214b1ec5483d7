// This study asks whether a model holds from where no beam of its log came from: a generated site,
// whose plants are triangles, is learnt from a drive and answered from above, from beside the track
// and from tripods among the plants.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/site_drive.hpp"
#include "studies/studies.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/metrics/look_up.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::studies {
namespace {

constexpr double kAboveGroundM = 0.3;  // What ends higher ends on a plant.

/// Beams of one kind of place, with their true answers.
struct View {
  std::string name;
  BeamLog beams;
};

/// The log of the drive to learn from, and the views to answer.
struct SiteLogs {
  BeamLog train;
  std::vector<View> views;
};

/// Returns up to `most` of the beams, spread evenly.
BeamLog thinned(const BeamLog& log, size_t most) {
  BeamLog out = log.like();
  const size_t step = std::max<size_t>(1, (log.size() + most - 1) / most);
  for (size_t i = 0; i < log.size(); i += step) out.append(log, i);
  return out;
}

/// Returns the beams with their origins moved by `shift` (m, world).
BeamLog moved(BeamLog beams, const Vec3& shift) {
  for (Vec3& origin : beams.origin) origin += shift;
  for (ScanInfo& scan : beams.info.scans) scan.world_from_sensor.translation += shift;
  return beams;
}

/// Returns the beams sent downwards from 30 m above the ground, within 6 m of the track along y and
/// tilted by at most 15° from straight down.
BeamLog from_overhead(BeamLog beams, const test_site::Site& site, uint64_t seed) {
  const double half_x = 0.4 * site.parameters.terrain.size_x_m;
  for (size_t i = 0; i < beams.size(); ++i) {
    Stream random(beam_key(seed, 0, i));
    const double x = (2 * random.uniform() - 1) * half_x;
    const double y = site.terrain.track_y(x) + 12 * random.uniform() - 6;
    const double bearing = 2 * M_PI * random.uniform();
    const double tilt = 15 * M_PI / 180 * std::sqrt(random.uniform());
    beams.origin[i] = Vec3(x, y, site.terrain.height(x, y) + 30);
    beams.direction[i] = Vec3(std::sin(tilt) * std::cos(bearing),
                              std::sin(tilt) * std::sin(bearing), -std::cos(tilt))
                             .cast<float>();
  }
  return beams;
}

/// Whether a place is at least 0.5 m outside the cylinders of all plants.
bool is_clear(const test_site::Site& site, double x, double y) {
  return std::all_of(site.placements.begin(), site.placements.end(), [&](const auto& p) {
    const Vec3& at = p.world_from_plant.translation;
    const double radius = p.scale * site.prototypes[p.prototype].radius_m;
    return std::hypot(at.x() - x, at.y() - y) > radius + 0.5;
  });
}

/// Returns the beams sent from tripods, 1.5 m above the ground and 4 to 10 m off the track where no
/// plant stands. Each scan of the log has a tripod of its own.
BeamLog from_tripods(BeamLog beams, const test_site::Site& site, uint64_t seed) {
  const double half_x = 0.4 * site.parameters.terrain.size_x_m;
  std::map<uint32_t, Vec3> shift;
  for (ScanInfo& scan : beams.info.scans) {
    Stream random(beam_key(seed, 1, scan.scan));
    for (int k = 0; k < 1000; ++k) {
      const double x = (2 * random.uniform() - 1) * half_x, off = 4 + 6 * random.uniform();
      const double y = site.terrain.track_y(x) + (random.uniform() < 0.5 ? -off : off);
      if (!is_clear(site, x, y)) continue;
      const Vec3 stand(x, y, site.terrain.height(x, y) + 1.5);
      shift[scan.scan] = stand - scan.world_from_sensor.translation;
      scan.world_from_sensor.translation = stand;
      break;
    }
  }
  BeamLog out = beams.like();
  for (size_t i = 0; i < beams.size(); ++i) {
    const auto at = shift.find(beams.scan[i]);
    if (at == shift.end()) continue;
    beams.origin[i] += at->second;
    out.append(beams, i);
  }
  return out;
}

/// Drives through the site. Every fourth scan trains, and the scans in the middle between them make
/// the views.
SiteLogs site_logs(const StudyRun& run, const GeneratedSite& site) {
  SiteDrive drive(site, sensor::load(run.quick ? "velodyne-hdl32e" : "velodyne-hdl64e"), run.seed);
  SiteLogs out;
  BeamLog chunk, between;
  size_t done = 0;
  while (drive.next(chunk)) {
    if (done == 0) out.train = between = chunk.like();
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.scan[i] % 4 == 0) out.train.append(chunk, i);
      if (chunk.scan[i] % 4 == 2) between.append(chunk, i);
    }
    done += chunk.size();
  }
  out.train.info = between.info = drive.info();
  drive.answer(0, out.train);
  out.train.extra.clear();
  const BeamLog beams = thinned(between, run.quick ? 5'000 : 100'000);
  out.views = {{"between the scans", beams},
               {"3 m higher", moved(beams, {0, 0, 3})},
               {"3 m aside", moved(beams, {0, 3, 0})},
               {"tripods", from_tripods(beams, site.site, run.seed)},
               {"overhead", from_overhead(beams, site.site, run.seed)}};
  size_t first = out.train.size();
  for (View& v : out.views) {
    drive.answer(first, v.beams);
    v.beams.extra.clear();
    first += v.beams.size();
  }
  return out;
}

/// What a source answers of a view.
struct ViewAnswer {
  double transmission = 0;  ///< Share of the beams that end on the ground or nowhere.
  double recall = 1, informedness = 1, capped_error_m = 0;
};

double transmission_of(const BeamLog& answered, const test_site::Terrain& terrain) {
  size_t passed = 0;
  for (size_t i = 0; i < answered.size(); ++i) {
    if (answered.is_hit(i)) {
      const Vec3 end = answered.end_point(i);
      passed += end.z() - terrain.height(end.x(), end.y()) < kAboveGroundM;
    } else {
      ++passed;
    }
  }
  return double(passed) / double(answered.size());
}

ViewAnswer answer_of(const BeamLog& truth, const BeamLog& answered, const test_site::Terrain& t) {
  MemorySource real(truth), simulated(answered);
  metrics::ScoreOptions options;
  options.cloud = false;
  const metrics::Summary s = metrics::score(real, simulated, options).all;
  return {transmission_of(answered, t), s.recall, s.informedness, s.capped_error_m};
}

/// A fitted model by its name in the table.
struct Contender {
  std::string name;
  elements::Model model;
};

std::vector<Contender> contenders(const StudyRun& run, const BeamLog& train) {
  std::vector<Contender> out;
  const auto add = [&](const std::string& name, fit::FitOptions options) {
    run.say(name);
    options.seed = run.seed;
    MemorySource source(train);
    out.push_back({name, pipeline::fit_model({source}, options).model});
  };
  add("default", {});
  fit::FitOptions voxel;
  voxel.fitter = "voxel";
  add("voxel", voxel);
  for (const bool carve : {false, true}) {
    if (run.quick) break;  // Meshes of leaves answer slowly.
    fit::FitOptions mesh;
    mesh.fitter = "surface";
    mesh.surface.carve = carve;
    add(carve ? "mesh, carved" : "mesh", mesh);
  }
  return out;
}

void add_row(const std::string& view, const std::string& source, const ViewAnswer& a,
             report::Table& table, StudyResult& result) {
  table.rows.push_back({view + "/" + source, fmt::format("{:.1f}", 100 * a.transmission),
                        fmt::format("{:.3f}", a.recall), fmt::format("{:.3f}", a.informedness),
                        fmt::format("{:.3f}", a.capped_error_m)});
  result.figures[view][source] = {{"transmission", a.transmission},
                                  {"answered", a.recall},
                                  {"informedness", a.informedness},
                                  {"capped_error_m", a.capped_error_m}};
}

/// Adds the rows of a view, of which the default is the first after the truth.
void add_view(const StudyRun& run, const View& view, const BeamLog& train,
              const std::vector<Contender>& models, const test_site::Terrain& terrain,
              report::Table& table, StudyResult& result) {
  ViewAnswer truth;
  truth.transmission = transmission_of(view.beams, terrain);
  add_row(view.name, "truth", truth, table, result);
  std::vector<ViewAnswer> answers;
  const auto add = [&](const std::string& name, const BeamLog& answered) {
    answers.push_back(answer_of(view.beams, answered, terrain));
    add_row(view.name, name, answers.back(), table, result);
  };
  for (const Contender& c : models) {
    pipeline::SimulateOptions options;
    options.seed = run.seed;
    add(c.name, pipeline::simulate_log(c.model, view.beams, options));
  }
  add("look-up", metrics::looked_up(train, view.beams, metrics::LookUp::kWarped2));
  add("always hit", metrics::always_hit(train, view.beams));
  const size_t misses =
      size_t(std::count(view.beams.range_m.begin(), view.beams.range_m.end(), kMiss));
  double error = INFINITY, informedness = -1;
  for (size_t k = 1; k < answers.size(); ++k) {
    error = std::min(error, answers[k].capped_error_m);
    informedness = std::max(informedness, answers[k].informedness);
  }
  result.checks.push_back({view.name + ", error of the transmission",
                           std::abs(answers[0].transmission / truth.transmission - 1), 0.1});
  result.checks.push_back({view.name + ", capped error over the best other source's",
                           answers[0].capped_error_m / error, 1});
  if (misses < view.beams.size() / 100) return;  // From above, nothing misses.
  result.checks.push_back({view.name + ", informedness less the best other source's",
                           answers[0].informedness - informedness, 0, false});
}

}  // namespace

StudyResult study_viewpoints(const StudyRun& run) {
  test_site::SiteParameters parameters;
  parameters.seed = run.seed;
  parameters.terrain.size_x_m = run.quick ? 14 : 40;
  parameters.terrain.size_y_m = run.quick ? 14 : 40;
  parameters.trees = run.quick ? 3 : 25;
  parameters.shrubs = run.quick ? 8 : 60;
  const GeneratedSite site(parameters);
  const SiteLogs logs = site_logs(run, site);
  run.say(fmt::format("{} beams train", logs.train.size()));
  const std::vector<Contender> models = contenders(run, logs.train);
  StudyResult out;
  out.lead =
      "A generated site, learnt from a drive through it and answered from poses that had no part "
      "in the training. Nothing there was measured.";
  report::Table table{
      "Other viewpoints",
      "Transmission: share of the beams that end within 0.3 m above the ground, or "
      "nowhere. Returns answered: share of the true returns that get a return.",
      {"view/source", "transmission, %", "returns answered", "informedness", "capped error, m"},
      {}};
  for (const View& view : logs.views) {
    add_view(run, view, logs.train, models, site.site.terrain, table, out);
  }
  out.tables.push_back(std::move(table));
  return out;
}

}  // namespace underbrush::studies
