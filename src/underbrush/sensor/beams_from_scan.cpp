#include "underbrush/sensor/beams_from_scan.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/organised_scan.hpp"
#include "underbrush/sensor/rays.hpp"
#include "underbrush/sensor/ring_numbers.hpp"
#include "underbrush/sensor/rings.hpp"

namespace underbrush::sensor {
namespace {

/// The inputs of one call and what is derived from them.
struct Job {
  const PointScan& scan;
  const Trajectory& trajectory;
  const BeamOptions& options;
  BeamCounts& counts;
  const Sensor* sensor;  // deskew, else infer_misses, else null
  double revolution_s;
};

void check(const PointScan& scan, const BeamOptions& options) {
  const size_t n = scan.size();
  require(n < SensorRay::kInserted, "beams_from_scan: too many points");
  require(scan.intensity.size() == n && (scan.time_s.empty() || scan.time_s.size() == n) &&
              (scan.ring.empty() || scan.ring.size() == n),
          "beams_from_scan: columns of different lengths");
  for (const auto& [name, column] : scan.extra) {
    require(std::visit([](const auto& c) { return c.size(); }, column) == n,
            "beams_from_scan: columns of different lengths");
  }
  for (const std::optional<Sensor>* sensor : {&options.deskew, &options.infer_misses}) {
    if (!*sensor) continue;
    (*sensor)->check();
    require((*sensor)->kind == Kind::kSpinning,
            "beams: the sensor of a scan must be a spinning one");
  }
  require(options.revolution_s >= 0 && std::isfinite(options.revolution_s) &&
              std::isfinite(options.elevation_offset_rad),
          "beams_from_scan: an option is not finite");
}

double revolution(const Sensor* sensor, const Trajectory& trajectory, double given_s) {
  if (given_s > 0 || !sensor) return given_s;
  const double own = 1 / sensor->rate_hz;
  const auto& poses = trajectory.poses();
  double sum = 0;
  size_t n = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    const double spacing = poses[i].time_s - poses[i - 1].time_s;
    if (std::abs(spacing - own) > 0.15 * own) continue;
    sum += spacing;
    ++n;
  }
  return n > 0 ? sum / double(n) : own;
}

// The numbers of rings as channels of the sensor.
std::vector<uint16_t> numbered(const Job& job, const std::vector<uint16_t>& rings) {
  std::vector<uint16_t> channels =
      channels_of_rings(rings, job.scan.point, *job.sensor, job.options.elevation_offset_rad);
  job.counts.scans_with_rings_renumbered += channels != rings;
  return channels;
}

std::vector<uint16_t> rings_of(const Job& job) {
  if (!job.sensor && !job.scan.ring.empty()) return job.scan.ring;
  if (!job.scan.ring.empty() && rings_are_numbered(job.scan, job.sensor->channels.size())) {
    return numbered(job, job.scan.ring);
  }
  std::vector<uint16_t> rings = rings_from_order(job.scan.point);
  const size_t found = rings.empty() ? 0 : rings.back() + size_t(1);
  if (!job.sensor) return found <= 256 ? rings : std::vector<uint16_t>(job.scan.size(), 0);
  if (found == 0) return rings;
  if (found == job.sensor->channels.size()) return numbered(job, rings);
  ++job.counts.scans_ringed_by_elevation;
  return rings_from_elevation(job.scan.point, *job.sensor, job.options.elevation_offset_rad);
}

// Packets of a revolution, as of an HDL-32E with its twelve firings a packet.
constexpr int kPacketsOfUnknownSensor = 180;

// Computes the time of a beam whose scan has no per-point time, from where the scanner looks.
double time_at(const Job& job, double azimuth) {
  if (!job.options.deskew) return job.scan.info.time_s;
  return job.scan.info.time_s +
         job.sensor->turn() * std::remainder(azimuth, 2 * M_PI) / (2 * M_PI) * job.revolution_s;
}

// Whether a point lies at this range, up to the rounding of floats and of files in millimetres.
bool is_at(const Vec3f& point, double range_m) {
  return range_m > 0 && std::abs(point.cast<double>().norm() - range_m) <= 1e-5 * range_m + 1e-3;
}

// Makes the rays of all stored points that are a return or a known miss.
std::vector<SensorRay> stored_rays(const Job& job, const std::optional<OrganisedScan>& grid) {
  const PointScan& scan = job.scan;
  const bool rows = grid && (scan.ring.empty() || !rings_are_numbered(scan, grid->rows));
  const std::vector<uint16_t> rings = rows ? std::vector<uint16_t>() : rings_of(job);
  const double fault = job.options.elevation_offset_rad, end_m = job.options.no_return_at_m;
  std::vector<SensorRay> rays;
  rays.reserve(scan.size());
  for (size_t i = 0; i < scan.size(); ++i) {
    SensorRay ray;
    ray.source = ray.place = uint32_t(i);
    ray.kind = kind_of(scan.point[i], job.sensor ? job.sensor->min_range_m : 0);
    const bool empty = ray.kind == PointKind::kReturn && is_at(scan.point[i], end_m);
    ray.ring = rings.empty() ? uint16_t(grid->row(i)) : rings[i];
    if (ray.kind != PointKind::kNothing) {
      ray.azimuth_rad = azimuth_of(scan.point[i]);
      ray.elevation_rad = elevation_of(scan.point[i]);
      if (empty) ray.kind = PointKind::kNothing;
    } else if (grid) {
      const Angles fired = grid->direction(i);
      ray.azimuth_rad = fired.azimuth_rad;
      ray.elevation_rad = fired.elevation_rad;
      if (ray.elevation_rad + fault < job.options.recorded_unknown_below_rad) {
        ++job.counts.unknown;
        continue;
      }
    } else {
      ++job.counts.skipped[kNoGrid];
      continue;
    }
    ray.time_s = scan.time_s.empty() ? time_at(job, ray.azimuth_rad) : scan.time_s[i];
    if (!std::isfinite(ray.time_s)) {
      ++job.counts.skipped["time not finite"];
      continue;
    }
    rays.push_back(ray);
  }
  return rays;
}

void infer(const Job& job, std::vector<SensorRay>& rays) {
  const Sensor& sensor = *job.options.infer_misses;
  const double step = 2 * M_PI * sensor.firing_period_s / job.revolution_s;
  const size_t stored = rays.size();
  const InsertedMisses done =
      insert_misses(rays, sensor, step, job.options.unknown_below_rad,
                    job.scan.info.world_from_sensor.rotation.conjugate() * Vec3::UnitZ(),
                    job.options.elevation_offset_rad, job.revolution_s, job.scan.info.time_s);
  job.counts.unknown += done.unknown;
  job.counts.scans_thinned += done.thinned;
  if (!job.scan.time_s.empty()) return;
  for (size_t i = stored; i < rays.size(); ++i) rays[i].time_s = time_at(job, rays[i].azimuth_rad);
}

// Finds the pose of each ray. Drops points that only keep their place in the grid, and beams
// without a pose.
std::vector<Pose> poses_and_drops(const Job& job, std::vector<SensorRay>& rays) {
  size_t near = 0, lost = 0;
  std::erase_if(rays, [&](const SensorRay& ray) {
    near += ray.kind == PointKind::kTooNear;
    return ray.kind == PointKind::kTooNear;
  });
  std::vector<Pose> poses(rays.size(), job.scan.info.world_from_sensor);
  if (job.options.deskew) {
    std::vector<uint8_t> found(rays.size());
    parallel_for(rays.size(), 8192, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const std::optional<Pose> pose = job.trajectory.at(rays[i].time_s);
        found[i] = pose.has_value();
        if (pose) poses[i] = *pose;
      }
    });
    size_t kept = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (!found[i]) continue;
      rays[kept] = rays[i];
      poses[kept++] = poses[i];
    }
    lost = rays.size() - kept;
    rays.resize(kept);
    poses.resize(kept);
  }
  if (near > 0) job.counts.skipped["nearer than the sensor's minimum range"] += near;
  if (lost > 0) job.counts.skipped["no pose at its time"] += lost;
  return poses;
}

// Rotates a unit vector up about d × z.
Vec3 raised(const Vec3& d, double angle) {
  const double flat = std::hypot(d.x(), d.y());
  if (angle == 0 || flat < 1e-9) return d;
  const Vec3 up = (Vec3::UnitZ() - d.z() * d) / flat;
  return (std::cos(angle) * d + std::sin(angle) * up).normalized();
}

void fill_packets(const Job& job, const std::vector<SensorRay>& rays, BeamLog& log) {
  if (!job.sensor) {
    for (size_t i = 0; i < rays.size(); ++i) {
      const double turned = 0.5 - std::remainder(rays[i].azimuth_rad, 2 * M_PI) / (2 * M_PI);
      log.packet[i] = uint32_t(turned * kPacketsOfUnknownSensor);
    }
    return;
  }
  if (rays.empty()) return;
  const double width = job.sensor->firing_period_s * job.sensor->firings_per_packet;
  double first = INFINITY;
  for (const SensorRay& ray : rays) first = std::min(first, ray.time_s);
  for (size_t i = 0; i < rays.size(); ++i) {
    const double turned =
        0.5 + job.sensor->turn() * std::remainder(rays[i].azimuth_rad, 2 * M_PI) / (2 * M_PI);
    const double phase =
        job.scan.time_s.empty() ? turned * job.revolution_s : rays[i].time_s - first;
    log.packet[i] = uint32_t(std::max(0.0, phase / width + 1e-6));
  }
}

template <class Column>
Column gathered(const Column& from, const std::vector<SensorRay>& rays) {
  Column out(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].source != SensorRay::kInserted) out[i] = from[rays[i].source];
  }
  return out;
}

BeamLog filled(const Job& job, const std::vector<SensorRay>& rays, const std::vector<Pose>& poses) {
  const PointScan& scan = job.scan;
  const double fault = job.options.elevation_offset_rad;
  BeamLog log;
  log.resize(rays.size());
  parallel_for(rays.size(), 8192, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const SensorRay& ray = rays[i];
      Vec3 d = unit_vector(ray.azimuth_rad, ray.elevation_rad);
      if (ray.kind == PointKind::kReturn) {
        d = scan.point[ray.source].cast<double>();
        log.range_m[i] = float(d.norm());
        d.normalize();
      }
      log.direction[i] = (poses[i].rotation * raised(d, fault)).cast<float>();
      log.origin[i] = poses[i].translation;
      log.time_s[i] = ray.time_s;
      log.ring[i] = ray.ring;
      log.scan[i] = scan.info.scan;
      log.flags[i] = ray.source == SensorRay::kInserted ? kInferred : 0;
    }
  });
  log.intensity = gathered(scan.intensity, rays);
  for (const auto& [name, column] : scan.extra) {
    log.extra[name] =
        std::visit([&](const auto& c) { return ExtraColumn(gathered(c, rays)); }, column);
  }
  fill_packets(job, rays, log);
  return log;
}

}  // namespace

BeamLog beams_from_scan(const PointScan& scan, const Trajectory& trajectory,
                        const BeamOptions& options, BeamCounts& counts) {
  check(scan, options);
  const Sensor* sensor = options.deskew         ? &*options.deskew
                         : options.infer_misses ? &*options.infer_misses
                                                : nullptr;
  const Job job{scan,   trajectory, options,
                counts, sensor,     revolution(sensor, trajectory, options.revolution_s)};

  const bool gaps = std::any_of(scan.point.begin(), scan.point.end(), [](const Vec3f& p) {
    return kind_of(p, 0) == PointKind::kNothing;
  });
  const std::optional<OrganisedScan> grid = gaps ? find_organised_scan(scan, sensor) : std::nullopt;
  std::vector<SensorRay> rays = stored_rays(job, grid);
  if (options.infer_misses && !grid) infer(job, rays);
  std::stable_sort(rays.begin(), rays.end(), [&](const SensorRay& a, const SensorRay& b) {
    if (!options.deskew) return a.place < b.place;
    return a.time_s != b.time_s ? a.time_s < b.time_s : a.ring < b.ring;
  });
  const std::vector<Pose> poses = poses_and_drops(job, rays);

  BeamLog log = filled(job, rays, poses);
  for (size_t i = 0; i < log.size(); ++i) {
    ++(log.is_hit(i)              ? counts.hits
       : log.flags[i] & kInferred ? counts.misses_inferred
                                  : counts.misses_recorded);
  }
  log.info.sensor = sensor ? sensor->name : "";
  log.info.sensor_file = sensor ? sensor->file : "";
  if (sensor) {
    log.info.min_range_m = sensor->min_range_m;
    log.info.max_range_m = sensor->max_range_m;
  }
  log.info.has_misses = grid || options.infer_misses || options.no_return_at_m > 0;
  log.info.deskewed = options.deskew.has_value();
  log.info.scans = {scan.info};
  return log;
}

}  // namespace underbrush::sensor
