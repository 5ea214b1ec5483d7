#include <algorithm>
#include <cmath>

#include "studies/analytic_scanner.hpp"
#include "studies/verification.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::studies {
namespace {

constexpr double kDistanceM = 24.0, kLookDownRad = 10 * M_PI / 180;

/// Turns directions as a leaning mirror does (`ScannerFault::mirror_tilt_rad`).
void tilt_mirror(const Pose& target_from_scanner, double tilt_rad, std::vector<Vec3f>& direction) {
  for (Vec3f& d : direction) {
    const Vec3 local = target_from_scanner.rotation.conjugate() * d.cast<double>();
    const double lean = tilt_rad * std::asin(std::clamp(local.z(), -1.0, 1.0));
    const Vec3 turned = Eigen::AngleAxisd(lean, Vec3::UnitZ()) * local;
    d = (target_from_scanner.rotation * turned).cast<float>();
  }
}

/// Simulates the beams of the scanner as `simulate --super-sample sensor` does, and with
/// `all_sub_rays` as `--all-sub-rays` does.
BeamLog answered(const Solid& solid, const sensor::Sensor& sensor, BeamLog beams, uint64_t seed,
                 bool all_sub_rays) {
  elements::Model model;
  model.surface = triangulated(solid).mesh;
  const pipeline::TracedWorld world(model);
  pipeline::SimulateOptions options;
  options.seed = seed;
  options.instrument.super_sample = "sensor";
  options.instrument.all_sub_rays = all_sub_rays;
  options.instrument.material = {"unknown=white_pvc"};
  pipeline::Simulation simulation(world, options, [&](const char*) { return sensor; });
  BeamLog out = pipeline::simulate_log(simulation, std::move(beams));
  keep_first_echoes(out);
  return out;
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
                             uint64_t seed, const ScannerFault& fault, bool all_sub_rays) {
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
  std::vector<Vec3f> reported = beams.direction;
  if (fault.mirror_tilt_rad != 0) tilt_mirror(pose, fault.mirror_tilt_rad, beams.direction);
  beams = answered(solid, sensor, std::move(beams), seed, all_sub_rays);
  beams.direction = std::move(reported);
  for (float& range : beams.range_m) range += float(fault.bias_m);
  SimulatedScan out;
  out.shots = beams.size();
  for (size_t i = 0; i < beams.size(); ++i) {
    if (beams.is_hit(i)) out.points.push_back(beams.end_point(i));
  }
  return out;
}

}  // namespace underbrush::studies
