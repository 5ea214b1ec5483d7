#include <algorithm>
#include <cmath>

#include "studies/analytic_scanner.hpp"
#include "studies/verification.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/radiometry/brdf.hpp"
#include "underbrush/radiometry/receiver.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::studies {
namespace {

constexpr double kDistanceM = 24.0, kLookDownRad = 10 * M_PI / 180;
constexpr double kReflectance = 0.6;  // Reflectance of opaque PVC, on which only faint edges
                                      // depend.

Vec3 normal_of(const elements::TriangleMesh& mesh, uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3 at = mesh.vertices[a].cast<double>();
  return (mesh.vertices[b].cast<double>() - at)
      .cross(mesh.vertices[c].cast<double>() - at)
      .normalized();
}

/// Turns directions as a leaning mirror does (`ScannerFault::mirror_tilt_rad`).
void tilt_mirror(const Pose& target_from_scanner, double tilt_rad, std::vector<Vec3f>& direction) {
  for (Vec3f& d : direction) {
    const Vec3 local = target_from_scanner.rotation.conjugate() * d.cast<double>();
    const double lean = tilt_rad * std::asin(std::clamp(local.z(), -1.0, 1.0));
    const Vec3 turned = Eigen::AngleAxisd(lean, Vec3::UnitZ()) * local;
    d = (target_from_scanner.rotation * turned).cast<float>();
  }
}

/// Computes the range of the first echo of every beam. Without `noise` the signal has none either.
void receive(const trace::World& world, const sensor::Sensor& sensor, double noise, uint64_t seed,
             BeamLog& beams) {
  const radiometry::Receiver receiver(radiometry::receiver_options(sensor, 0, noise > 0 ? 1 : 0));
  const sensor::RayMaker maker(sensor.beam);
  const auto places = sensor::grid_sub_rays(sensor.beam, sensor.sub_rays[0], sensor.sub_rays[1]);
  const trace::RangeLimits limits{sensor.min_range_m, 100};
  const elements::TriangleMesh& mesh = world.model().surface;
  parallel_for(beams.size(), 4096, [&](size_t begin, size_t end) {
    radiometry::Waveform scratch = receiver.scratch();
    std::vector<float> range, weight, factor, signal;
    for (size_t i = begin; i < end; ++i) {
      const Ray axis = beams.ray(i);
      const sensor::BeamAxes axes = sensor::beam_axes(axis);
      range.clear(), weight.clear(), factor.clear();
      for (const auto& [u, v, share] : places) {
        const Ray ray = maker.ray(axes, u, v);
        const trace::Intersection met = world.nearest_surface(ray, limits);
        if (met.none()) continue;
        const double cosine = std::abs(normal_of(mesh, met.element).dot(ray.direction));
        range.push_back(float(met.t_m));
        weight.push_back(share);
        factor.push_back(float(kReflectance * radiometry::backscatter({}, cosine)));
      }
      if (range.empty()) continue;
      signal.resize(range.size());
      const radiometry::Echoes echoes = receiver.receive(range, weight, factor, signal,
                                                         beam_key(seed, beams.scan[i], i), scratch);
      if (echoes.count > 0) beams.range_m[i] = echoes.echo[0].range_m;
    }
  });
}

}  // namespace

Pose miniature_from_scanner() {
  const Vec3 middle(-0.5, -0.5, 0.5);
  const Pose turned{
      Eigen::AngleAxisd(M_PI / 4, Vec3::UnitZ()) * Eigen::AngleAxisd(kLookDownRad, Vec3::UnitY()),
      Vec3::Zero()};
  return {turned.rotation, middle - kDistanceM * (turned * Vec3::UnitX())};
}

std::array<double, 2> raster_phase(int scan) {
  const auto part = [](double x) { return x - std::floor(x); };
  return {part(scan * 0.7548776662466927), part(scan * 0.5698402909980532)};
}

std::vector<Vec3> instrument_scan(const Solid& target, const Pose& pose, int scan, uint64_t seed) {
  AnalyticScanOptions instrument;
  instrument.seed = seed + 1000 + uint64_t(scan);
  const auto [across, up] = raster_phase(scan);
  instrument.azimuth_phase = across + 0.5;
  instrument.elevation_phase = up + 0.5;
  return analytic_scan(target, pose, instrument).points;
}

SimulatedScan simulated_scan(const Solid& solid, const Pose& target_from_scanner, int scan,
                             uint64_t seed, const ScannerFault& fault) {
  sensor::Sensor sensor = sensor::load("optech-ilris-3d");
  sensor.range_sigma_m *= fault.noise;
  const sensor::Raster& raster = sensor.raster;
  const auto [across, up] = raster_phase(scan);
  const double step = std::abs(raster.azimuth_to_rad - raster.azimuth_from_rad) /
                      (raster.columns - 1);  // The same amount upwards.
  Pose pose = target_from_scanner;
  pose.rotation = pose.rotation * Eigen::AngleAxisd(across * step, Vec3::UnitZ()) *
                  Eigen::AngleAxisd(up * step, Vec3::UnitY());
  const double cycle = sensor.shot_cycle_s();
  const Trajectory still({{0, pose}, {2 * cycle, pose}});
  BeamLog beams = sensor::beams(sensor, still, 0, cycle);
  elements::Model model;
  model.surface = triangulated(solid).mesh;
  const trace::World world(model);
  const std::vector<Vec3f> reported = beams.direction;
  if (fault.mirror_tilt_rad != 0) tilt_mirror(pose, fault.mirror_tilt_rad, beams.direction);
  receive(world, sensor, fault.noise, seed, beams);
  beams.direction = reported;
  for (float& range : beams.range_m) range += float(fault.bias_m);
  SimulatedScan out;
  out.shots = beams.size();
  for (size_t i = 0; i < beams.size(); ++i) {
    if (beams.is_hit(i)) out.points.push_back(beams.end_point(i));
  }
  return out;
}

}  // namespace underbrush::studies
