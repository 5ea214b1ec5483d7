#include <algorithm>
#include <cmath>

#include "study/mesh_fidelity.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/scene/tree.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/footprint.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::app {
namespace {

constexpr double kVolumeM3 = 45;
constexpr double kSpeedMS = 2.5, kFromM = 18, kToM = 6;
constexpr double kFrontHeightM = 0.8, kAboveM = 1, kBehindM = 1.4;

/// Scales to a box of 45 m³.
void scale(scene::PlantMesh& plant) {
  const double factor = std::cbrt(kVolumeM3 / scene::bounds(plant.mesh).volume());
  for (Vec3f& v : plant.mesh.vertices) v *= float(factor);
}

/// A board across the vehicle's way, as flat as one picture of a tree.
scene::PlantMesh billboard() {
  scene::PlantMesh out;
  const double half = std::sqrt(kVolumeM3 / 5.5) / 2;
  const uint32_t a = out.add_vertex({0, -half, 0}), b = out.add_vertex({0, half, 0});
  const uint32_t c = out.add_vertex({0, half, 5.5}), d = out.add_vertex({0, -half, 5.5});
  out.add_triangle(a, b, c, scene::Part::kLeaf);
  out.add_triangle(a, c, d, scene::Part::kLeaf);
  return out;
}

/// A ball of leaves on a stick.
scene::PlantMesh cartoon() {
  constexpr int kAround = 12, kUp = 6;
  scene::PlantMesh out;
  const scene::TubePoint stick[] = {{{0, 0, 0}, 0.15}, {{0, 0, 2.5}, 0.1}};
  scene::add_tube(out, stick, 8);
  const auto at = [&](int i, int j) {
    const double zenith = M_PI * i / kUp, azimuth = 2 * M_PI * j / kAround;
    return Vec3(1.5 * std::sin(zenith) * std::cos(azimuth),
                1.5 * std::sin(zenith) * std::sin(azimuth), 3.5 + 1.5 * std::cos(zenith));
  };
  for (int i = 0; i < kUp; ++i) {
    for (int j = 0; j < kAround; ++j) {
      const uint32_t a = out.add_vertex(at(i, j)), b = out.add_vertex(at(i + 1, j));
      const uint32_t c = out.add_vertex(at(i + 1, j + 1)), d = out.add_vertex(at(i, j + 1));
      if (i + 1 < kUp) out.add_triangle(a, b, c, scene::Part::kLeaf);
      if (i > 0) out.add_triangle(a, c, d, scene::Part::kLeaf);
    }
  }
  scale(out);
  return out;
}

/// The same leaf area in leaves of this length.
scene::PlantMesh tree_with(double leaf_length_m, scene::Species species, uint64_t seed) {
  scene::TreeParameters p = scene::typical_tree(species, 5.5);
  p.crown_radius_m = 1.35;
  p.crown_base_m = 1;
  const double before = p.foliage.leaf_length_m;
  p.foliage.area_m2 = 3 * M_PI * p.crown_radius_m * p.crown_radius_m;
  p.foliage.leaf_length_m = leaf_length_m;
  p.foliage.leaf_width_m *= leaf_length_m / before;
  scene::PlantMesh out = scene::tree(p, seed);
  scale(out);
  return out;
}

}  // namespace

std::vector<SweepPlant> sweep_plants(bool quick, uint64_t seed) {
  std::vector<SweepPlant> out;
  out.push_back({"billboard", billboard()});
  out.push_back({"cartoon", cartoon()});
  const std::vector<double> lengths =
      quick ? std::vector{0.6, 0.08}
            : std::vector{1.2, 0.8, 0.5, 0.3, 0.18, 0.11, 0.07, 0.04, 0.025, 0.015, 0.0085};
  for (const double length : lengths) {
    for (const auto species : {scene::Species::kBroadleaf, scene::Species::kConifer}) {
      if (quick && species == scene::Species::kConifer) continue;
      const char* kind = species == scene::Species::kBroadleaf ? "broadleaf" : "conifer";
      out.push_back({std::string(kind) + " " + std::to_string(int(1000 * length)) + " mm",
                     tree_with(length, species, seed)});
    }
  }
  return out;
}

BeamLog approach_beams(const scene::PlantMesh& plant, bool quick) {
  const sensor::Sensor sensor = sensor::load("ouster-os1-64");
  const double seconds = (kFromM - kToM) / kSpeedMS;
  const auto box = scene::bounds(plant.mesh);
  const Vec3 middle = box.center();
  const double radius = box.diagonal().norm() / 2;
  BeamLog out;
  for (const bool top : {false, true}) {
    const double behind = top ? kBehindM : 0, height = kFrontHeightM + (top ? kAboveM : 0);
    const auto at = [&](double t) {
      return Pose{Eigen::Quaterniond::Identity(), {-kFromM - behind + kSpeedMS * t, 0, height}};
    };
    const Trajectory way({{0, at(0)}, {seconds, at(seconds)}});
    sensor::PatternSource pattern(sensor, way, 0, seconds - 0.1, 1 << 18);
    if (out.empty()) out.info = pattern.info();
    BeamLog chunk;
    while (pattern.next(chunk)) {
      for (size_t i = 0; i < chunk.size(); ++i) {
        if (quick && chunk.scan[i] % 8 != 0) continue;
        const Vec3 to = middle - chunk.origin[i], d = chunk.direction[i].cast<double>();
        if (to.dot(d) < 0 || (to - to.dot(d) * d).norm() > radius) continue;
        out.append(chunk, i);
      }
    }
  }
  out.info.has_misses = true;
  return out;
}

BeamLog approach_scan(const scene::PlantMesh& plant, const BeamLog& beams, uint64_t seed) {
  const sensor::Sensor sensor = sensor::load("ouster-os1-64");
  elements::Model model;
  model.surface = plant.mesh;
  const trace::World world(model);
  simulate::FootprintOptions options;
  options.seed = seed;
  options.shape = sensor.beam;
  options.range_sigma_m = sensor.range_sigma_m;
  const std::vector<elements::Class> label(model.size(), elements::Class::kUnknown);
  BeamLog out = beams;
  simulate::scan(world, label, options, 0, out);
  out.extra.clear();
  const auto step = float(sensor.range_resolution_m);
  for (float& r : out.range_m) {
    if (r != kMiss) r = std::round(r / step) * step;
  }
  return out;
}

metrics::LeafInclination leaves_of(const BeamLog& log) {
  std::vector<Vec3f> cloud;
  for (size_t i = 0; i < log.size(); ++i) {
    if (log.is_hit(i)) cloud.push_back(log.end_point(i).cast<float>());
  }
  return metrics::leaf_inclination(cloud);
}

PlantFigures figures_of(const SweepPlant& plant, const BeamLog& scan) {
  const elements::TriangleMesh& mesh = plant.plant.mesh;
  return {plant.name, mesh.size(),
          mesh.vertices.size() * sizeof(Vec3f) + mesh.size() * sizeof(mesh.triangles[0]),
          leaves_of(scan)};
}

PlantFigures ellipsoids_of(const BeamLog& scan, uint64_t seed) {
  fit::FitOptions options;
  options.seed = seed;
  options.segment.method = "none";
  MemorySource source(scan);
  const elements::Model model = fit::fit(source, options).model;
  const trace::World world(model);
  simulate::Options draw;
  draw.seed = seed + 1;
  BeamLog answer = scan;
  simulate::simulate(world, draw, 0, answer);
  return {"ellipsoids", model.size(), model.ellipsoids.size() * sizeof(elements::Ellipsoid),
          leaves_of(answer)};
}

}  // namespace underbrush::app
