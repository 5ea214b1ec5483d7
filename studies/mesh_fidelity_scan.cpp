#include <algorithm>
#include <cmath>

#include "studies/mesh_fidelity.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/footprint.hpp"

namespace underbrush::studies {
namespace {

constexpr double kSpeedMS = 2.5;
constexpr double kFrontHeightM = 0.8, kAboveM = 1, kBehindM = 1.4;

/// Returns the pose of the lower sensor at time t (s).
Pose vehicle(double t, double plant_front_m, const ApproachOptions& options) {
  const auto wave = [t](double hertz, double phase) {
    return std::sin(2 * M_PI * hertz * t + phase);
  };
  Pose pose;
  pose.rotation = Eigen::AngleAxisd(options.tilt_rad * wave(1.1, 0.4), Vec3::UnitY()) *
                  Eigen::AngleAxisd(options.tilt_rad * wave(0.8, 2.1), Vec3::UnitX());
  pose.translation = {plant_front_m - options.from_m + kSpeedMS * t, 0,
                      kFrontHeightM + options.heave_m * wave(1.3, 1.2)};
  return pose;
}

Trajectory way_of(bool top, double plant_front_m, const ApproachOptions& options) {
  const Vec3 mount = top ? Vec3(-kBehindM, 0, kAboveM) : Vec3(0, 0, 0);
  std::vector<StampedPose> poses;
  for (double t = 0; t < (options.from_m - options.to_m) / kSpeedMS + 0.02; t += 0.02) {
    const Pose at = vehicle(t, plant_front_m, options);
    poses.push_back({t, Pose{at.rotation, at * mount}});
  }
  return Trajectory(std::move(poses));
}

/// Returns the small turn and shift that registration leaves; it is the same for both sensors of a
/// scan.
Pose misplaced(uint32_t scan, const ApproachOptions& options, uint64_t seed) {
  Stream random(mix64(seed) ^ mix64(scan + 1));
  Vec3 turn, shift;
  for (int i = 0; i < 3; ++i) {
    turn[i] = options.registration_rad * random.normal();
    shift[i] = options.registration_m * random.normal();
  }
  Pose out;
  const double angle = turn.norm();
  if (angle > 0) out.rotation = Eigen::AngleAxisd(angle, turn / angle);
  out.translation = shift;
  return out;
}

}  // namespace

BeamLog approach_beams(const test_site::PlantMesh& plant, bool quick,
                       const ApproachOptions& options) {
  const sensor::Sensor sensor = sensor::load(options.sensor);
  const double seconds = (options.from_m - options.to_m) / kSpeedMS;
  const auto box = test_site::bounds(plant.mesh);
  const Vec3 middle = box.center();
  const double radius = box.diagonal().norm() / 2;
  BeamLog out;
  for (const bool top : {false, true}) {
    if (!top && !options.lower) continue;
    const Trajectory way = way_of(top, box.min().x(), options);
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

BeamLog approach_scan(const test_site::PlantMesh& plant, const BeamLog& beams, uint64_t seed,
                      const RangingOptions& ranging) {
  const sensor::Sensor sensor = sensor::load(beams.info.sensor);
  elements::Model model;
  model.surface = plant.mesh;
  const trace::World world(model);
  simulate::FootprintOptions options;
  options.seed = seed;
  options.shape = sensor.beam;
  options.range_sigma_m = ranging.sigma_m.value_or(sensor.range_sigma_m);
  options.sub_rays = ranging.sub_rays;
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

std::vector<Vec3f> registered(const BeamLog& log, const ApproachOptions& options, uint64_t seed) {
  std::vector<Vec3f> cloud;
  Pose wrong;
  for (size_t i = 0; i < log.size(); ++i) {
    if (i == 0 || log.scan[i] != log.scan[i - 1]) wrong = misplaced(log.scan[i], options, seed);
    if (!log.is_hit(i)) continue;
    const Vec3 seen = log.range_m[i] * log.direction[i].cast<double>();
    cloud.push_back((log.origin[i] + wrong * seen).cast<float>());
  }
  return cloud;
}

PlantFigures figures_of(const SweepPlant& plant, const BeamLog& scan, uint64_t seed) {
  const elements::TriangleMesh& mesh = plant.plant.mesh;
  return {plant.name,
          mesh.size(),
          mesh.vertices.size() * sizeof(Vec3f) + mesh.size() * sizeof(mesh.triangles[0]),
          plant.crude,
          metrics::leaf_inclination(registered(scan, {}, seed)),
          metrics::leaf_inclination(registered(scan, kOdometry, seed))};
}

PlantFigures ellipsoids_of(const BeamLog& scan, uint64_t seed) {
  fit::FitOptions options;
  options.seed = seed;
  MemorySource source(scan);
  const elements::Model model = pipeline::fit_model({source}, options).model;
  pipeline::SimulateOptions options_of_draw;
  options_of_draw.seed = seed + 1;
  const BeamLog answer = pipeline::simulate_log(model, scan, options_of_draw);
  return {"ellipsoids",
          model.size(),
          model.ellipsoids.size() * sizeof(elements::Ellipsoid),
          false,
          metrics::leaf_inclination(registered(answer, {}, seed)),
          metrics::leaf_inclination(registered(answer, kOdometry, seed))};
}

std::vector<Vec3f> surface_points(const test_site::PlantMesh& plant, size_t n, uint64_t seed) {
  const elements::TriangleMesh& mesh = plant.mesh;
  std::vector<double> area_to(mesh.size());
  double sum = 0;
  for (size_t t = 0; t < mesh.size(); ++t) area_to[t] = sum += test_site::triangle_area(mesh, t);
  Stream random(seed);
  std::vector<Vec3f> out(n);
  for (Vec3f& p : out) {
    const double at = random.uniform(0, sum);
    const auto t =
        size_t(std::lower_bound(area_to.begin(), area_to.end() - 1, at) - area_to.begin());
    const float u = float(std::sqrt(random.uniform())), v = float(random.uniform());
    const auto& [a, b, c] = mesh.triangles[t];
    p = (1 - u) * mesh.vertices[a] + u * (1 - v) * mesh.vertices[b] + u * v * mesh.vertices[c];
  }
  return out;
}

}  // namespace underbrush::studies
