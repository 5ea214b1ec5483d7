#include "underbrush/metrics/look_up.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/median.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/metrics/beams_by_place.hpp"

namespace underbrush::metrics {
namespace {

/// A scan of a log: its rows, and where and when it was taken.
struct Scan {
  std::vector<uint32_t> rows;
  Vec3 origin = Vec3::Zero();  ///< m, world; the mean over its beams.
  double time_s = 0;
  Mat3 sensor_from_world = Mat3::Identity();
};

std::map<uint32_t, Scan> scans_of(const BeamLog& log) {
  std::map<uint32_t, Scan> scans;
  for (size_t i = 0; i < log.size(); ++i) {
    Scan& s = scans[log.scan[i]];
    s.rows.push_back(uint32_t(i));
    s.origin += log.origin[i];
    s.time_s += log.time_s[i];
  }
  for (auto& [number, s] : scans) {
    s.origin /= double(s.rows.size());
    s.time_s /= double(s.rows.size());
  }
  for (const ScanInfo& info : log.info.scans) {
    const auto at = scans.find(info.scan);
    if (at == scans.end()) continue;
    at->second.sensor_from_world = info.world_from_sensor.rotation.conjugate().toRotationMatrix();
  }
  return scans;
}

/// Returns the `count` training scans that were taken nearest to `of`.
std::vector<const Scan*> nearest_scans(const std::map<uint32_t, Scan>& train, const Scan& of,
                                       size_t count) {
  constexpr double kMetresASecond = 0.01;  // Time decides where the sensor stands.
  std::vector<std::pair<double, const Scan*>> order;
  order.reserve(train.size());
  for (const auto& [number, s] : train) {
    order.emplace_back(
        (s.origin - of.origin).norm() + kMetresASecond * std::abs(s.time_s - of.time_s), &s);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const Scan*> out;
  for (size_t k = 0; k < std::min(count, order.size()); ++k) out.push_back(order[k].second);
  return out;
}

/// The median angle between neighbouring rings, rad; infinite where there is one ring.
double ring_spacing(const BeamLog& log, const std::map<uint32_t, Scan>& scans) {
  std::map<uint16_t, std::pair<double, size_t>> elevation;
  for (const auto& [number, s] : scans) {
    for (const uint32_t i : s.rows) {
      const Vec3 d = s.sensor_from_world * log.direction[i].cast<double>();
      auto& [sum, n] = elevation[log.ring[i]];
      sum += std::asin(std::clamp(d.z(), -1.0, 1.0));
      ++n;
    }
  }
  std::vector<double> mean, step;
  for (const auto& [ring, e] : elevation) mean.push_back(e.first / double(e.second));
  std::sort(mean.begin(), mean.end());
  for (size_t k = 1; k < mean.size(); ++k) step.push_back(mean[k] - mean[k - 1]);
  return median<double>(std::move(step), INFINITY);
}

/// The median angle between successive beams of a ring, rad; infinite where no ring has two.
double beam_spacing(const BeamLog& log, const std::map<uint32_t, Scan>& scans) {
  std::vector<double> step;
  for (const auto& [number, s] : scans) {
    std::map<uint16_t, uint32_t> last;
    for (const uint32_t i : s.rows) {
      const auto [before, first] = last.try_emplace(log.ring[i], i);
      if (!first) step.push_back(double((log.direction[i] - log.direction[before->second]).norm()));
      before->second = i;
    }
  }
  return median<double>(std::move(step), INFINITY);
}

constexpr size_t kNear = 32;   // Training beams that are looked at for a beam.
constexpr float kWide = 0.1F;  // m on the unit sphere; almost all beams have as many within it.
constexpr float kAll = 4;      // Every direction is nearer than that to every other.

/// How far around a beam `kNear` training beams of some scans usually lie, twice the area for
/// safety: a chord, at most `kWide`.
float usual_margin(const BeamLog& train, const std::map<uint32_t, Scan>& scans, size_t count) {
  const double of_each = ring_spacing(train, scans) * beam_spacing(train, scans);
  return float(std::min<double>(kWide, std::sqrt(2 * kNear * of_each / (M_PI * double(count)))));
}

SeenBeams seen_by_sensor(const BeamLog& train, const Scan& scan) {
  SeenBeams c{{}, scan.rows};
  c.direction.reserve(scan.rows.size());
  for (const uint32_t i : scan.rows) {
    c.direction.push_back(
        (scan.sensor_from_world * train.direction[i].cast<double>()).cast<float>());
  }
  return c;
}

/// Rows of a scan whose origins lie in one cube.
std::vector<std::vector<uint32_t>> cubes_of(const BeamLog& log, const Scan& scan) {
  constexpr double kSide = 0.05;  // m
  std::map<std::array<int64_t, 3>, std::vector<uint32_t>> cubes;
  for (const uint32_t i : scan.rows) {
    const Vec3 at = (log.origin[i] - scan.origin) / kSide;
    cubes[{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())}].push_back(i);
  }
  std::vector<std::vector<uint32_t>> out;
  out.reserve(cubes.size());
  for (auto& [key, rows] : cubes) out.push_back(std::move(rows));
  return out;
}

/// The answer to a beam, taken from a training beam.
struct Answer {
  float range_m = kMiss, intensity = 0;
};

/// What one beam is answered: the nearest of some training beams in angle, or the nearest in range
/// of those within `half_beam`, the length of a chord.
Answer answer(const Vec3& origin, const Vec3& direction, const BeamLog& train,
              std::span<const uint32_t> near, double half_beam) {
  double least = INFINITY;
  Answer nearest, within;
  for (const uint32_t i : near) {
    const double apart = (direction_from(origin, train, i) - direction).norm();
    Answer here;
    if (train.is_hit(i)) here = {float((train.end_point(i) - origin).norm()), train.intensity[i]};
    if (apart < least) least = apart, nearest = here;
    if (apart <= half_beam && here.range_m < within.range_m) within = here;
  }
  return within.range_m == kMiss ? nearest : within;
}

/// Answers some beams of a scan whose origins are near `place`: a tree of what is seen from there
/// has the candidates, and each beam's own origin decides among them. The tree has what is up to
/// `margin` (of directions) away from the beams. Returns the beams for which that was not enough.
std::vector<uint32_t> look_up_within(const BeamLog& train, const BeamsByPlace& beams,
                                     const Vec3& place, const std::vector<uint32_t>& rows,
                                     double half_beam, float margin, BeamLog& out) {
  Eigen::AlignedBox3f box;
  for (const uint32_t i : rows) box.extend(out.direction[i]);
  box.min().array() -= margin;
  box.max().array() += margin;
  const SeenBeams c = beams.seen_from(place, box);
  if (c.row.empty()) return rows;
  const CloudTree tree(c.direction);
  std::vector<uint8_t> is_answered(rows.size());
  parallel_for(rows.size(), 256, [&](size_t begin, size_t end) {
    uint32_t index[kNear];
    float distance2[kNear];
    for (size_t k = begin; k < end; ++k) {
      const uint32_t i = rows[k];
      const size_t n = tree.nearest(out.direction[i].data(), kNear, index, distance2);
      is_answered[k] = n == kNear && distance2[n - 1] < margin * margin;
      if (!is_answered[k] && margin < kAll) continue;
      for (size_t j = 0; j < n; ++j) index[j] = c.row[index[j]];
      const Answer a =
          answer(out.origin[i], out.direction[i].cast<double>(), train, {index, n}, half_beam);
      out.range_m[i] = a.range_m;
      out.intensity[i] = a.intensity;
    }
  });
  std::vector<uint32_t> left;
  for (size_t k = 0; k < rows.size(); ++k) {
    if (!is_answered[k]) left.push_back(rows[k]);
  }
  return left;
}

void look_up_warped(const BeamLog& train, const BeamsByPlace& beams,
                    const std::vector<uint32_t>& rows, double half_beam, float usual,
                    BeamLog& out) {
  Vec3 place = Vec3::Zero();
  for (const uint32_t i : rows) place += out.origin[i] / double(rows.size());
  std::vector<uint32_t> left = rows;
  float tried = 0;
  for (const float margin : {usual, kWide, kAll}) {
    if (left.empty() || margin == tried) continue;
    left = look_up_within(train, beams, place, left, half_beam, margin, out);
    tried = margin;
  }
}

void look_up_raw(const BeamLog& train, const Scan& from, const Scan& to, BeamLog& out) {
  const SeenBeams c = seen_by_sensor(train, from);
  const CloudTree tree(c.direction);
  parallel_for(to.rows.size(), 256, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const uint32_t i = to.rows[k];
      const Vec3f d = (to.sensor_from_world * out.direction[i].cast<double>()).cast<float>();
      uint32_t index = 0;
      float distance2 = 0;
      tree.nearest(d.data(), 1, &index, &distance2);
      out.range_m[i] = train.range_m[c.row[index]];
      out.intensity[i] = train.intensity[c.row[index]];
    }
  });
}

}  // namespace

BeamLog looked_up(const BeamLog& train, const BeamLog& test, LookUp kind) {
  const std::map<uint32_t, Scan> from = scans_of(train), to = scans_of(test);
  const double half_beam = 0.5 * std::min(ring_spacing(test, to), beam_spacing(test, to));
  const size_t count = kind == LookUp::kWarped2 ? 2 : 1;
  const float usual = kind == LookUp::kRaw ? kWide : usual_margin(train, from, count);
  BeamLog out = test;
  std::fill(out.range_m.begin(), out.range_m.end(), kMiss);
  std::fill(out.intensity.begin(), out.intensity.end(), 0.f);
  for (const auto& [number, scan] : to) {
    const auto scans = nearest_scans(from, scan, count);
    if (scans.empty()) continue;
    if (kind == LookUp::kRaw) {
      look_up_raw(train, *scans[0], scan, out);
      continue;
    }
    std::vector<uint32_t> rows_of_scans;
    for (const Scan* s : scans) {
      rows_of_scans.insert(rows_of_scans.end(), s->rows.begin(), s->rows.end());
    }
    const BeamsByPlace beams(train, std::move(rows_of_scans));
    for (const std::vector<uint32_t>& rows : cubes_of(test, scan)) {
      look_up_warped(train, beams, rows, half_beam, usual, out);
    }
  }
  return out;
}

}  // namespace underbrush::metrics
