#include "underbrush/osi/lidar_log.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/static_data.hpp"
#include "underbrush/radiometry/response.hpp"

namespace underbrush::osi {
namespace {

using radiometry::kSpeedOfLight;

constexpr double kDarkest = 1e-9;  // Share of white below which an intensity is written as 0.

double decibels(double share, double range_m, size_t rays) {
  return 10 * std::log10(std::max(share, kDarkest) * double(rays) / (range_m * range_m));
}

double share_of(double db, double range_m, size_t rays) {
  const double share = std::pow(10, db / 10) * range_m * range_m / double(rays);
  return share <= 1.000001 * kDarkest ? 0 : share;
}

uint32_t microseconds(double time_s) {
  return uint32_t(std::clamp(std::round(time_s * 1e6), 0.0, 4e9));
}

void append_ray(const BeamLog& rows, size_t i, const ScanInfo& scan, const LidarLogOptions& options,
                size_t rays, LidarSensorView& out) {
  const Pose back = scan.world_from_sensor.inverse();
  LidarConfiguration& c = *out.configuration;
  Reflection f;
  Vec3 direction = back.rotation * rows.direction[i].cast<double>();
  if (rows.is_hit(i)) {
    const Vec3 p = back * rows.end_point(i);
    const double range = std::max(p.norm(), kLeastRangeM);
    direction = p / range;
    f.time_of_flight_s = 2 * range / kSpeedOfLight;
    f.signal_db = decibels(double(rows.intensity[i]) / options.white_intensity, range, rays);
  }
  c.directions.push_back(direction.normalized().cast<float>());
  c.timings_us.push_back(microseconds(rows.time_s[i] - scan.time_s));
  out.reflections.push_back(f);
}

size_t most_rows(const std::vector<bool>& begins) {
  size_t most = 1, rows = 0;
  for (const bool b : begins) {
    rows = b ? 1 : rows + 1;
    most = std::max(most, rows);
  }
  return most;
}

size_t rays_per_beam(const LidarConfiguration& c) {
  const size_t rays = c.directions.size();
  return c.beams && *c.beams && rays % *c.beams == 0 ? rays / *c.beams : 1;
}

}  // namespace

SensorView view_of(const BeamLog& rows, const ScanInfo& scan, const LidarLogOptions& options) {
  require(options.white_intensity > 0, "osi: the intensity of white must be positive");
  const std::vector<bool> begins = begins_beam(rows);
  const size_t rays = most_rows(begins);
  SensorView v;
  v.version = Version{};
  v.timestamp = Timestamp::of(scan.time_s);
  v.sensor_id = options.sensor_id;
  v.mounting = Mounting::of({});
  LidarSensorView& l = v.lidar.emplace_back();
  LidarConfiguration& c = l.configuration.emplace();
  c.sensor_id = options.sensor_id;
  c.mounting = v.mounting;
  uint32_t beams = 0;
  for (size_t i = 0; i < rows.size(); ++beams) {
    size_t end = i + 1;
    while (end < rows.size() && !begins[end]) ++end;
    for (size_t k = i; k < end; ++k) append_ray(rows, k, scan, options, rays, l);
    for (size_t k = end - i; k < rays; ++k) {
      c.directions.push_back(c.directions.back());
      c.timings_us.push_back(c.timings_us.back());
      l.reflections.emplace_back();
    }
    i = end;
  }
  c.rays_horizontal = uint32_t(c.directions.size());
  c.rays_vertical = 1;
  c.most_interactions = 1;
  c.beams = beams;
  return v;
}

void append_beams(const SensorView& view, uint32_t scan, const LidarLogOptions& options,
                  BeamLog& log) {
  require_data(view.timestamp.has_value(), "the view has no time");
  const MovingObject* host = view.host();
  const Pose vehicle = host ? world_from_vehicle(*host) : Pose{};
  const double time_s = view.timestamp->s();
  auto& echo = std::get<std::vector<uint8_t>>(
      log.extra.try_emplace(kEchoColumn, std::vector<uint8_t>(log.size())).first->second);
  auto& echoes = std::get<std::vector<uint8_t>>(
      log.extra.try_emplace(kEchoesColumn, std::vector<uint8_t>(log.size())).first->second);
  for (const LidarSensorView& l : view.lidar) {
    require_data(l.configuration && l.configuration->directions.size() == l.reflections.size(),
                 "the number of reflections is not that of the rays");
    const LidarConfiguration& c = *l.configuration;
    const size_t rays = rays_per_beam(c);
    const Pose pose = c.mounting ? vehicle * c.mounting->pose() : vehicle;
    if (log.info.scans.empty() || log.info.scans.back().scan != scan) {
      log.info.scans.push_back({scan, time_s, pose});
    }
    for (size_t b = 0; b < l.reflections.size(); b += rays) {
      uint8_t found = 0;
      for (size_t k = 0; k < rays; ++k) found += !l.reflections[b + k].is_miss();
      uint8_t number = 0;
      for (size_t k = 0; k < rays; ++k) {
        const Reflection& f = l.reflections[b + k];
        if (f.is_miss() && (found > 0 || k > 0)) continue;
        const size_t row = log.size();
        log.resize(row + 1);
        log.origin[row] = pose.translation;
        log.direction[row] =
            (pose.rotation * c.directions[b + k].cast<double>()).normalized().cast<float>();
        log.time_s[row] = time_s;
        if (b + k < c.timings_us.size()) log.time_s[row] += 1e-6 * double(c.timings_us[b + k]);
        log.scan[row] = scan;
        echo[row] = echoes[row] = 0;
        if (f.is_miss()) continue;
        const double range = f.time_of_flight_s * kSpeedOfLight / 2;
        log.range_m[row] = float(range);
        log.intensity[row] = float(share_of(f.signal_db, range, rays) * options.white_intensity);
        echo[row] = ++number;
        echoes[row] = found;
      }
    }
  }
}

BeamLog log_of_views(TraceReader& reader, const LidarLogOptions& options) {
  BeamLog log;
  log.info.has_misses = true;
  StaticData known;
  for (std::string message; reader.next(message);) {
    SensorView view = read_sensor_view(std::move(message), reader.place());
    known.fill(view);
    try {
      append_beams(view, uint32_t(reader.read() - 1), options, log);
    } catch (const DataError& e) {
      throw FormatError(reader.place(), "", e.what());
    }
  }
  require_data(!log.empty(), "the views have no reflections");
  for (size_t i = 0; i < log.size(); ++i) {
    if (!log.is_hit(i)) continue;
    log.info.max_range_m = std::max(log.info.max_range_m, std::ceil(double(log.range_m[i])));
  }
  return log;
}

}  // namespace underbrush::osi
