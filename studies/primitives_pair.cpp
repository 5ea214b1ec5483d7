#include <algorithm>
#include <cmath>

#include "studies/primitives.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/labelled_log.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/primitives/leave_out.hpp"
#include "underbrush/primitives/log_ground.hpp"
#include "underbrush/primitives/segment_log.hpp"

namespace underbrush::studies {
namespace {

using primitives::Primitive;

BeamLog answered(const pipeline::TracedWorld& world, const BeamLog& beams, uint64_t seed) {
  pipeline::SimulateOptions options;
  options.seed = seed;
  pipeline::Simulation simulation(world, options);
  return pipeline::simulate_log(simulation, beams);
}

metrics::Score score_of(const BeamLog& real, const BeamLog& simulated) {
  MemorySource a(real), b(simulated);
  return metrics::score(a, b, {});
}

elements::Model fitted(const BeamLog& log, double min_range_m, uint64_t seed) {
  fit::FitOptions options;
  options.min_range_m = min_range_m;
  options.seed = seed;
  MemorySource source(log);
  return pipeline::fit_model({source}, options).model;
}

/// Leaves out the primitives that the sensor of the test could see.
size_t drop_seen(const BeamLog& test, double far_m, std::vector<Primitive>& primitives) {
  return std::erase_if(primitives, [&](const Primitive& p) {
    return std::any_of(test.info.scans.begin(), test.info.scans.end(), [&](const ScanInfo& s) {
      return (s.world_from_sensor.translation - p.source.position).head<2>().norm() < far_m;
    });
  });
}

/// The test site without the elements of its plants.
struct Site {
  elements::Model ground;
  primitives::Annotation annotation;
};

Site annotated(const BeamLog& test, double max_range_m) {
  Site site;
  MemorySource source(test);
  site.ground = primitives::ground_of_log("test log", source);
  site.ground.max_range_m = max_range_m;
  const primitives::GroundSurface surface(site.ground);
  source.rewind();
  site.annotation.objects = primitives::measure_objects(source, surface, {}).objects;
  return site;
}

}  // namespace

PairOutcome run_pair(const SitePair& pair, const PairOptions& o) {
  PairOutcome out;
  out.name = pair.name;
  out.train_beams = pair.train.size();
  out.test_beams = pair.test.size();
  const elements::Model model = fitted(pair.train, pair.min_range_m, o.seed);
  MemorySource train(pair.train);
  std::vector<Primitive> cut = primitives::extract(model, train, {}).primitives;
  if (pair.one_site) out.seen_by_both = drop_seen(pair.test, model.max_range_m, cut);
  if (o.change) o.change(cut);
  require(!o.meshes.empty(), "study: there are no meshes to compare with");
  primitives::write_primitives(o.work, cut, primitives::MeasureOptions{}.cell_m, "");

  const Site site = annotated(pair.test, model.max_range_m);
  std::vector<MeshSet> sets{{"primitives", o.work}};
  sets.insert(sets.end(), o.meshes.begin(), o.meshes.end());
  std::vector<primitives::PrimitiveSet> read(sets.size());
  std::vector<primitives::Composition> composed(sets.size());
  std::vector<BeamLog> logs(sets.size());
  std::vector<Composed> shown;
  primitives::ComposeOptions compose;
  compose.seed = o.seed;
  for (size_t k = 0; k < sets.size(); ++k) {
    read[k] = primitives::read_primitive_set(sets[k].folder);
    if (pair.one_site) out.shared_plants += primitives::leave_out(read[k], site.annotation.objects);
    require(!read[k].entries.empty(), "study: no primitive is left of the training log");
    composed[k] = primitives::compose(site.annotation, site.ground, read[k], compose);
    logs[k] =
        answered(pipeline::TracedWorld(composed[k].scene, composed[k].info), pair.test, o.seed);
    out.rows.push_back(sets[k].name);
    out.score[sets[k].name] = score_of(pair.test, logs[k]);
    out.box_distance_m.push_back(composed[k].mean_box_distance_m);
    shown.push_back({sets[k].name, &read[k], &composed[k].scene, &logs[k]});
  }
  out.primitives = read[0].entries.size();
  out.objects = composed[0].objects;
  out.left_out = composed[0].objects - composed[0].placed;
  if (o.pictures)
    out.pictures = primitive_pictures(pair.name, pair.test, std::span(shown).first(2));
  const elements::Model own = fitted(pair.test, pair.min_range_m, o.seed);
  out.score["geospecific"] =
      score_of(pair.test, answered(pipeline::TracedWorld(own), pair.test, o.seed));
  out.rows.insert(out.rows.end(), {"geospecific", "replay", "always hit"});
  out.score["replay"] = score_of(pair.test, replay(pair.train, pair.test));
  out.score["always hit"] = score_of(pair.test, metrics::always_hit(pair.train, pair.test));
  return out;
}

BeamLog replay(const BeamLog& train, const BeamLog& test) {
  require(!train.info.scans.empty() && !test.info.scans.empty(), "replay: a log has no scan poses");
  const auto azimuth = [](const BeamLog& log, size_t i, const ScanInfo& scan) {
    const Vec3 d = scan.world_from_sensor.rotation.conjugate() * log.direction[i].cast<double>();
    return std::atan2(d.y(), d.x());
  };
  const auto by_number = [](const BeamLog& log) {
    std::map<uint32_t, const ScanInfo*> out;
    for (const ScanInfo& s : log.info.scans) out[s.scan] = &s;
    return out;
  };
  // Azimuth and range of what each ring of each training scan saw.
  std::map<std::pair<uint32_t, uint16_t>, std::vector<std::pair<double, float>>> seen;
  const auto train_scans = by_number(train), test_scans = by_number(test);
  for (size_t i = 0; i < train.size(); ++i) {
    seen[{train.scan[i], train.ring[i]}].emplace_back(
        azimuth(train, i, *train_scans.at(train.scan[i])), train.range_m[i]);
  }
  for (auto& [key, ring] : seen) std::sort(ring.begin(), ring.end());
  std::map<uint32_t, uint32_t> nearest;  // The training scan that belongs to each test scan.
  for (const auto& [number, scan] : test_scans) {
    double least = INFINITY;
    for (const auto& [other, there] : train_scans) {
      const double d = (there->world_from_sensor.translation - scan->world_from_sensor.translation)
                           .squaredNorm();
      if (d < least) least = d, nearest[number] = other;
    }
  }
  BeamLog out = test;
  for (size_t i = 0; i < test.size(); ++i) {
    const auto ring = seen.find({nearest.at(test.scan[i]), test.ring[i]});
    out.range_m[i] = kMiss;
    if (ring == seen.end()) continue;
    const double a = azimuth(test, i, *test_scans.at(test.scan[i]));
    const auto& beams = ring->second;
    const auto above = std::lower_bound(beams.begin(), beams.end(), std::pair(a, 0.f));
    const auto& next = above == beams.end() ? beams.front() : *above;
    const auto& last = above == beams.begin() ? beams.back() : *std::prev(above);
    const auto off = [&](double b) { return std::abs(std::remainder(a - b, 2 * M_PI)); };
    out.range_m[i] = off(next.first) < off(last.first) ? next.second : last.second;
  }
  return out;
}

void label_log(BeamLog& log, double min_range_m) {
  primitives::SegmentLogOptions options;
  options.min_range_m = min_range_m;
  MemorySource source(log);
  const primitives::LogLabels labels = primitives::segment_log(source, options);
  pipeline::LabelledCounts unscored("", false);
  pipeline::put_labels(pipeline::found_of(labels), 0, log, unscored);
  log.info.classes = "underbrush";
}

}  // namespace underbrush::studies
