#include <algorithm>
#include <cmath>

#include "studies/primitives.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/pipeline/annotate_site.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/labelled_log.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/primitives/leave_out.hpp"
#include "underbrush/primitives/measure.hpp"
#include "underbrush/primitives/segment_log.hpp"

namespace underbrush::studies {
using primitives::Primitive;
namespace {

constexpr size_t kPointsOfMesh = 4096;

/// Points drawn evenly over the area of a mesh.
std::vector<Vec3> points_on(const elements::TriangleMesh& mesh) {
  const auto corner = [&](size_t t, size_t k) -> Vec3 {
    return mesh.vertices[mesh.triangles[t][k]].cast<double>();
  };
  std::vector<double> area(mesh.triangles.size());
  for (size_t t = 0; t < area.size(); ++t) {
    area[t] = (t > 0 ? area[t - 1] : 0) +
              (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
  }
  Stream random(1);
  std::vector<Vec3> out(kPointsOfMesh);
  for (size_t k = 0; k < out.size(); ++k) {
    const double at = (double(k) + 0.5) / double(out.size()) * area.back();
    const auto t = size_t(std::ranges::lower_bound(area, at) - area.begin());
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    out[k] = corner(t, 0) + u * (corner(t, 1) - corner(t, 0)) + v * (corner(t, 2) - corner(t, 0));
  }
  return out;
}

}  // namespace

BeamLog answers_of_world(const pipeline::TracedWorld& world, const BeamLog& beams, uint64_t seed) {
  pipeline::SimulateOptions options;
  options.seed = seed;
  pipeline::Simulation simulation(world, options);
  return pipeline::simulate_log(simulation, beams);
}

metrics::Score scores_of(const BeamLog& real, const BeamLog& simulated) {
  MemorySource a(real), b(simulated);
  return metrics::score(a, b, {});
}

elements::Model fit_of_log(const BeamLog& log, double min_range_m, uint64_t seed) {
  fit::FitOptions options;
  options.min_range_m = min_range_m;
  options.seed = seed;
  MemorySource source(log);
  return pipeline::fit_model({source}, options).model;
}

AnnotatedSite annotated_site(const BeamLog& test, double max_range_m) {
  MemorySource source(test);
  pipeline::AnnotatedSite found = pipeline::annotate_site("test log", &source, "", {});
  AnnotatedSite site{std::move(found.ground), {}};
  site.ground.max_range_m = max_range_m;
  site.annotation.objects = std::move(found.measured.objects);
  return site;
}

CutPrimitives cut_primitives(const SitePair& pair, const elements::Model& trained,
                             const AnnotatedSite& site, const pipeline::ExtractOptions& options) {
  MemorySource train(pair.train);
  CutPrimitives out{
      pipeline::extract_primitives(trained, "training log", train, options).primitives};
  if (!pair.one_site) return out;
  out.seen_by_both = std::erase_if(out.primitives, [&](const Primitive& p) {
    return std::any_of(
        pair.test.info.scans.begin(), pair.test.info.scans.end(), [&](const ScanInfo& s) {
          return (s.world_from_sensor.translation - p.source.position).head<2>().norm() <
                 trained.max_range_m;
        });
  });
  out.shared_plants = std::erase_if(out.primitives, [&](const Primitive& p) {
    return std::any_of(
        site.annotation.objects.begin(), site.annotation.objects.end(),
        [&](const primitives::PlacedObject& o) { return primitives::share_ground(p.source, o); });
  });
  return out;
}

primitives::PrimitiveSet adaptable_meshes(primitives::PrimitiveSet set) {
  for (size_t k = 0; k < set.entries.size(); ++k) {
    set.entries[k].layers = primitives::layers_of(points_on(read_primitive(set, k).surface));
  }
  return set;
}

PairOutcome run_pair(const SitePair& pair, const PairOptions& o) {
  PairOutcome out;
  out.name = pair.name;
  out.train_beams = pair.train.size();
  out.test_beams = pair.test.size();
  require(!o.meshes.empty(), "study: there are no meshes to compare with");
  const elements::Model model = fit_of_log(pair.train, pair.min_range_m, o.seed);
  const AnnotatedSite site = annotated_site(pair.test, model.max_range_m);
  CutPrimitives cut = cut_primitives(pair, model, site);
  out.seen_by_both = cut.seen_by_both;
  out.shared_plants = cut.shared_plants;
  require(!cut.primitives.empty(), "study: no primitive is left of the training log");
  if (o.change) o.change(cut.primitives);
  std::vector<std::string> names{"primitives"};
  std::vector<primitives::PrimitiveSet> sets;
  sets.push_back(
      primitives::primitive_set(std::move(cut.primitives), primitives::MeasureOptions{}.cell_m));
  for (const MeshSet& meshes : o.meshes) {
    names.push_back(meshes.name);
    sets.push_back(primitives::read_primitive_set(meshes.folder));
    if (meshes.adapted) sets.back() = adaptable_meshes(std::move(sets.back()));
  }
  std::vector<primitives::Composition> composed(sets.size());
  std::vector<BeamLog> logs(sets.size());
  std::vector<Composed> shown;
  pipeline::ComposeOptions compose;
  compose.seed = o.seed;
  for (size_t k = 0; k < sets.size(); ++k) {
    composed[k] = pipeline::compose_scene(site.annotation, site.ground, sets[k], compose);
    logs[k] = answers_of_world(pipeline::TracedWorld(composed[k].scene, composed[k].info),
                               pair.test, o.seed);
    out.rows.push_back(names[k]);
    out.score[names[k]] = scores_of(pair.test, logs[k]);
    out.box_distance_m.push_back(composed[k].mean_box_distance_m);
    shown.push_back({names[k], &sets[k], &composed[k].scene, &logs[k]});
  }
  out.primitives = sets[0].entries.size();
  out.objects = composed[0].objects;
  out.left_out = composed[0].objects - composed[0].placed;
  if (o.pictures)
    out.pictures = primitive_pictures(pair.name, pair.test, std::span(shown).first(2));
  const elements::Model own = fit_of_log(pair.test, pair.min_range_m, o.seed);
  out.score["geospecific"] =
      scores_of(pair.test, answers_of_world(pipeline::TracedWorld(own), pair.test, o.seed));
  out.rows.insert(out.rows.end(), {"geospecific", "replay", "always hit"});
  out.score["replay"] = scores_of(pair.test, replay(pair.train, pair.test));
  out.score["always hit"] = scores_of(pair.test, metrics::always_hit(pair.train, pair.test));
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
