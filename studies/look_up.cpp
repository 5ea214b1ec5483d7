#include "studies/look_up.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"

namespace underbrush::studies {
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

/// Half of the median angle between neighbouring rings, rad.
double half_spacing(const BeamLog& log, const std::map<uint32_t, Scan>& scans) {
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
  if (step.empty()) return 0.0035;
  std::nth_element(step.begin(), step.begin() + ptrdiff_t(step.size() / 2), step.end());
  return 0.5 * step[step.size() / 2];
}

/// The training beams that a scan's beams are looked up in.
struct Candidates {
  std::vector<Vec3f> direction;
  std::vector<Vec3> point;     ///< m, world; meaningless for a miss.
  std::vector<float> range_m;  ///< As measured, or kMiss.
};

Candidates candidates_of(const BeamLog& train, const std::vector<const Scan*>& scans,
                         const Scan& seen_from, bool warped) {
  Candidates c;
  for (const Scan* s : scans) {
    for (const uint32_t i : s->rows) {
      const Vec3 point = train.end_point(i);
      Vec3 d = train.direction[i].cast<double>();
      if (!warped) {
        d = s->sensor_from_world * d;
      } else if (train.is_hit(i)) {
        d = (point - seen_from.origin).normalized();
      }
      c.direction.push_back(d.cast<float>());
      c.point.push_back(point);
      c.range_m.push_back(train.range_m[i]);
    }
  }
  return c;
}

}  // namespace

BeamLog looked_up(const BeamLog& train, const BeamLog& test, LookUp how) {
  const std::map<uint32_t, Scan> from = scans_of(train), to = scans_of(test);
  const bool warped = how != LookUp::kRaw;
  const double within = 2 * std::sin(half_spacing(test, to) / 2), most = within * within;
  BeamLog out = test;
  std::fill(out.range_m.begin(), out.range_m.end(), kMiss);
  for (const auto& entry : to) {
    const Scan& scan = entry.second;
    const auto scans = nearest_scans(from, scan, how == LookUp::kWarped2 ? 2 : 1);
    const Candidates c = candidates_of(train, scans, scan, warped);
    if (c.direction.empty()) continue;
    const CloudTree tree(c.direction);
    parallel_for(scan.rows.size(), 256, [&](size_t begin, size_t end) {
      constexpr size_t kNear = 12;
      uint32_t index[kNear];
      float distance2[kNear];
      for (size_t k = begin; k < end; ++k) {
        const uint32_t i = scan.rows[k];
        Vec3f d = test.direction[i];
        if (!warped) d = (scan.sensor_from_world * d.cast<double>()).cast<float>();
        const size_t n = tree.nearest(d.data(), warped ? kNear : 1, index, distance2);
        float range = kMiss;
        for (size_t j = 0; j < n; ++j) {
          if (j > 0 && double(distance2[j]) > most) break;
          if (c.range_m[index[j]] == kMiss) continue;
          const float r =
              warped ? float((c.point[index[j]] - test.origin[i]).norm()) : c.range_m[index[j]];
          range = std::min(range, r);
        }
        out.range_m[i] = range;
      }
    });
  }
  return out;
}

}  // namespace underbrush::studies
