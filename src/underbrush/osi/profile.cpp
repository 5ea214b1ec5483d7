#include "underbrush/osi/profile.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/radiometry/response.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::osi {
namespace {

constexpr double kFirstS = 0.5;  // Within the standing vehicle's trajectory.

Trajectory standstill() { return Trajectory({{0, Pose{}}, {10, Pose{}}}); }

void set_field(const BeamLog& beams, LidarConfiguration& c) {
  double left = -M_PI, right = M_PI, low = M_PI, high = -M_PI;
  for (const Vec3f& d : beams.direction) {
    const double azimuth = std::atan2(double(d.y()), double(d.x()));
    const double elevation = std::asin(std::clamp(double(d.z()), -1.0, 1.0));
    left = std::max(left, azimuth);
    right = std::min(right, azimuth);
    low = std::min(low, elevation);
    high = std::max(high, elevation);
  }
  c.field_horizontal_rad = left - right;
  c.field_vertical_rad = high - low;
}

}  // namespace

Profile make_profile(const std::string& name, int columns, int rows) {
  Profile p;
  p.sensor = sensor::load(name);
  if (columns <= 0) columns = p.sensor.sub_rays[0];
  if (rows <= 0) rows = p.sensor.sub_rays[1];
  p.sub_rays = columns * rows == 1 ? std::vector<sensor::SubRay>{{}}
                                   : sensor::grid_sub_rays(p.sensor.beam, columns, rows);
  for (const sensor::SubRay& s : p.sub_rays) p.weight.push_back(s.weight);
  const double cycle_s =
      p.sensor.kind == sensor::Kind::kSpinning ? 1 / p.sensor.rate_hz : p.sensor.shot_cycle_s();
  const Trajectory path = standstill();
  sensor::PatternSource source(p.sensor, path, kFirstS, kFirstS + cycle_s * (1 - 1e-9));
  LidarConfiguration& c = p.configuration;
  const sensor::RayMaker maker(p.sensor.beam);
  BeamLog all = [&] {
    BeamLog out;
    for (BeamLog chunk; source.next(chunk);) out.append(chunk, 0, chunk.size());
    return out;
  }();
  for (size_t i = 0; i < all.size(); ++i) {
    const sensor::BeamAxes axes = sensor::beam_axes(all.ray(i));
    const auto t = uint32_t(std::lround((all.time_s[i] - kFirstS) * 1e6));
    for (const sensor::SubRay& s : p.sub_rays) {
      const Vec3 d = p.sub_rays.size() == 1 ? axes.axis.direction
                                            : maker.ray(axes, double(s.u), double(s.v)).direction;
      c.directions.push_back(d.cast<float>());
      c.timings_us.push_back(t);
    }
  }
  set_field(all, c);
  c.rays_horizontal = uint32_t(c.directions.size());
  c.rays_vertical = 1;
  c.most_interactions = 1;
  c.beams = uint32_t(all.size());
  if (p.sensor.wavelength_m > 0) {
    c.emitter_frequency_hz = radiometry::kSpeedOfLight / p.sensor.wavelength_m;
  }
  return p;
}

SensorViewConfiguration request_of(const Profile& p, uint64_t sensor_id, const Mounting& mounting) {
  SensorViewConfiguration c;
  c.version = Version{};
  c.sensor_id = sensor_id;
  c.mounting = mounting;
  c.field_horizontal_rad = p.configuration.field_horizontal_rad;
  c.field_vertical_rad = p.configuration.field_vertical_rad;
  c.range_m = p.sensor.max_range_m;
  c.cycle_s =
      p.sensor.kind == sensor::Kind::kSpinning ? 1 / p.sensor.rate_hz : p.sensor.shot_cycle_s();
  c.lidar = {p.configuration};
  c.lidar[0].sensor_id = sensor_id;
  c.lidar[0].mounting = mounting;
  return c;
}

std::vector<Vec3> beam_directions(const LidarConfiguration& c, size_t rays_per_beam) {
  require(rays_per_beam > 0 && c.directions.size() % rays_per_beam == 0,
          "osi: the number of rays is no multiple of the rays of a beam");
  std::vector<Vec3> out;
  out.reserve(c.directions.size() / rays_per_beam);
  for (size_t i = 0; i < c.directions.size(); i += rays_per_beam) {
    Vec3 sum = Vec3::Zero();
    for (size_t k = 0; k < rays_per_beam; ++k) sum += c.directions[i + k].cast<double>();
    const double norm = sum.norm();
    out.push_back(norm > 0 ? Vec3(sum / norm) : c.directions[i].cast<double>());
  }
  return out;
}

}  // namespace underbrush::osi
