#include "studies/verification_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::studies {
namespace {

constexpr double kOwnVehicleM = 3;    // m; nearer returns are of the vehicle itself.
constexpr double kFarM = 40;          // m; farther away the rings lie too far apart to find planes.
constexpr double kOnPlaneM = 0.15;    // m; a return further off is of something else.
constexpr double kWallUpright = 0.5;  // Largest vertical part of an upright plane's normal.
constexpr size_t kLeastBeams = 50;
constexpr uint32_t kNoWall = ~uint32_t(0);

bool is_used(const BeamLog& log, size_t i) {
  return log.is_hit(i) && log.range_m[i] > kOwnVehicleM && log.range_m[i] < kFarM;
}

/// Returns the planes as faces of a solid whose vertices are the outlines.
Solid solid_of(const std::vector<PlanarPatch>& patches) {
  Solid faces;
  for (const PlanarPatch& patch : patches) {
    std::vector<uint32_t> corners;
    for (const Vec3& corner : patch.outline) {
      corners.push_back(uint32_t(faces.vertices.size()));
      faces.vertices.push_back(corner);
    }
    faces.faces.push_back(std::move(corners));
  }
  return faces;
}

/// Returns how the range to a plane through the beam's end changes with the lean of the mirror.
double change_with_lean(const Plane& plane, const Mat3& sensor_from_world, const Ray& beam,
                        double range_m) {
  const double elevation =
      std::asin(std::clamp((sensor_from_world * beam.direction).z(), -1.0, 1.0));
  const Vec3 up = sensor_from_world.transpose() * Vec3::UnitZ();
  const double along = plane.normal.dot(beam.direction);
  return -elevation * range_m * plane.normal.dot(up.cross(beam.direction)) / along;
}

/// Turns directions as a leaning mirror does (`ScannerFault::mirror_tilt_rad`).
void lean(const Mat3& sensor_from_world, double tilt_rad, BeamLog& beams) {
  for (Vec3f& d : beams.direction) {
    const Vec3 local = sensor_from_world * d.cast<double>();
    const double angle = tilt_rad * std::asin(std::clamp(local.z(), -1.0, 1.0));
    const Vec3 turned = Eigen::AngleAxisd(angle, Vec3::UnitZ()) * local;
    d = (sensor_from_world.transpose() * turned).cast<float>();
  }
}

}  // namespace

WallScan::WallScan(const BeamLog& scan) : first_(scan.like()), second_(scan.like()) {
  require(!scan.empty(), "walls: a scan without beams");
  constexpr size_t kNone = ~size_t(0);
  struct Ring {
    size_t first = kNone, second = kNone;  // The last beams of the ring in the two halves.
  };
  std::map<uint16_t, Ring> rings;
  std::vector<std::array<size_t, 2>> about;  // Of each beam of the second half, in the first half.
  for (size_t i = 0; i < scan.size(); ++i) {
    Ring& ring = rings[scan.ring[i]];
    if (ring.first == kNone || ring.second != kNone) {
      if (ring.second != kNone) about[ring.second][1] = first_.size();
      ring = {first_.size(), kNone};
      first_.append(scan, i);
    } else {
      ring.second = second_.size();
      about.push_back({ring.first, kNone});
      second_.append(scan, i);
    }
  }
  for (const ScanInfo& info : scan.info.scans) {
    if (info.scan != scan.scan[0]) continue;
    sensor_from_world_ = info.world_from_sensor.rotation.conjugate().toRotationMatrix();
  }
  origin_ = scan.origin[0];
  std::vector<Vec3f> cloud;
  std::vector<size_t> beam;
  for (size_t i = 0; i < first_.size(); ++i) {
    if (!is_used(first_, i)) continue;
    cloud.push_back((first_.end_point(i) - origin_).cast<float>());
    beam.push_back(i);
  }
  PatchOptions options;
  options.most_patches = 40;
  options.least_points = 150;
  std::vector<uint32_t> wall_of_first(first_.size(), kNoWall);
  for (PlanarPatch& patch : planar_patches(cloud, options)) {
    if (std::abs(patch.plane.normal.z()) > kWallUpright) continue;
    for (const uint32_t i : patch.points) wall_of_first[beam[i]] = uint32_t(patches_.size());
    patches_.push_back(std::move(patch));
  }
  require(!patches_.empty(), "walls: no upright plane");
  for (const auto& [before, after] : about) {
    const bool between = after != kNone && wall_of_first[before] == wall_of_first[after];
    wall_.push_back(between ? wall_of_first[before] : kNoWall);
  }
}

elements::Model WallScan::faces() const {
  elements::Model model;
  model.origin = origin_;
  model.surface = triangulated(solid_of(patches_)).mesh;
  model.surface.range_sigma_m = 0;
  return model;
}

elements::Model WallScan::fitted(uint64_t seed) const {
  fit::FitOptions options;
  options.seed = seed;
  options.min_range_m = kOwnVehicleM;
  MemorySource source(first_);
  return pipeline::fit_model({source}, options).model;
}

std::vector<Wall> WallScan::compare(WallSource source, const ScannerFault& fault,
                                    uint64_t seed) const {
  const bool fit = source == WallSource::kFit;
  const elements::Model model = fit ? fitted(seed) : faces();
  BeamLog simulated = second_;
  lean(sensor_from_world_, fault.mirror_tilt_rad, simulated);
  pipeline::SimulateOptions options;
  options.seed = seed;
  simulated = pipeline::simulate_log(model, std::move(simulated), options);
  simulated.direction = second_.direction;
  const double sheet_m =
      source == WallSource::kDataSheet ? sensor::load(first_.info.sensor).range_sigma_m : 0;
  std::vector<Wall> all(patches_.size());
  std::vector<std::vector<Vec3>> real_points(patches_.size()), points(patches_.size());
  for (size_t i = 0; i < second_.size(); ++i) {
    const uint32_t k = wall_[i];
    if (k == kNoWall || !is_used(second_, i) || !simulated.is_hit(i)) continue;
    const Plane& plane = patches_[k].plane;
    const double slant = std::abs(plane.normal.dot(second_.ray(i).direction));
    const double sigma_m = sheet_m > 0 ? sheet_m : fit ? 0 : std::sqrt(plane.variance) / slant;
    const uint64_t key = beam_key(seed, second_.scan[i], i);
    const double noise_m = fault.noise * sigma_m * normal(key, 1, Purpose::kNoise);
    simulated.range_m[i] += float(noise_m + fault.bias_m);
    const Vec3 real = second_.end_point(i) - origin_, ours = simulated.end_point(i) - origin_;
    if (std::abs(plane.distance(real)) > kOnPlaneM || std::abs(plane.distance(ours)) > kOnPlaneM) {
      continue;
    }
    real_points[k].push_back(real);
    points[k].push_back(ours);
    const double measured = double(second_.range_m[i]);
    const double difference = double(simulated.range_m[i]) - measured;
    const double change = change_with_lean(plane, sensor_from_world_, second_.ray(i), measured);
    all[k].offset_m += difference;
    all[k].lean_sum += change * difference;
    all[k].lean_weight += change * change;
  }
  std::vector<Wall> out;
  for (size_t k = 0; k < all.size(); ++k) {
    Wall& wall = all[k];
    wall.points = points[k].size();
    if (wall.points < kLeastBeams) continue;
    wall.plane = patches_[k].plane;
    wall.real = fit_plane(real_points[k]);
    wall.simulated = fit_plane(points[k]);
    wall.offset_m /= double(wall.points);
    out.push_back(wall);
  }
  return out;
}

Bounded bounded(const std::vector<double>& values) {
  require(values.size() > 1, "an interval needs two values");
  // The 99.5 % point of Student's t is tabulated up to ν = 4; beyond, it is expanded about the
  // normal distribution's (Cornish and Fisher).
  constexpr double kTable[] = {63.657, 9.925, 5.841, 4.604};
  constexpr double kNormal = 2.575829;
  const double n = double(values.size()), v = n - 1, z2 = kNormal * kNormal;
  const double t =
      v <= 4 ? kTable[size_t(v) - 1]
             : kNormal * (1 + (z2 + 1) / (4 * v) + ((5 * z2 + 16) * z2 + 3) / (96 * v * v) +
                          (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * v * v * v));
  double mean = 0, squares = 0;
  for (const double x : values) mean += x / n;
  for (const double x : values) squares += (x - mean) * (x - mean) / v;
  const double reach = t * std::sqrt(squares / n);
  return {mean, mean - reach, mean + reach};
}

}  // namespace underbrush::studies
