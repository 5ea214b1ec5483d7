#include "underbrush/sensor/rings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "underbrush/sensor/angles.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kGapSteps = 1.8;  // 0.30° at the HDL-64E's 0.167°

using Ring = std::vector<SensorRay>;

// Computes the gap from ray i to the next one counter-clockwise, across the seam of the ring.
double gap_after(const Ring& ring, size_t i) {
  return i + 1 < ring.size() ? ring[i + 1].azimuth_rad - ring[i].azimuth_rad
                             : ring[0].azimuth_rad + 2 * M_PI - ring[i].azimuth_rad;
}

// The step of a scan whose firings are regular but farther apart than those of the sensor, as at 20
// turns a second in place of 10; else nothing. Misses alone leave no regular gaps.
std::optional<double> wider_step(const std::vector<Ring>& rings, double nominal) {
  constexpr size_t kFewest = 100;
  constexpr double kSame = 0.15, kMost = 0.6;
  std::vector<double> gaps;
  for (const Ring& ring : rings) {
    for (size_t i = 0; i + 1 < ring.size(); ++i) {
      if (gap_after(ring, i) >= 0.05 * nominal) gaps.push_back(gap_after(ring, i));
    }
  }
  const double middle = median(gaps);
  if (gaps.size() < kFewest || middle <= kGapSteps * nominal) return std::nullopt;
  double sum = 0;
  size_t same = 0;
  for (const double gap : gaps) {
    if (std::abs(gap - middle) > kSame * middle) continue;
    sum += gap;
    ++same;
  }
  if (double(same) < kMost * double(gaps.size())) return std::nullopt;
  return sum / double(same);
}

double measured_step(const std::vector<Ring>& rings, double nominal) {
  if (const std::optional<double> wider = wider_step(rings, nominal)) return *wider;
  std::vector<double> steps;
  for (const Ring& ring : rings) {
    double sum = 0;
    size_t n = 0;
    for (size_t i = 0; i + 1 < ring.size(); ++i) {
      const double gap = gap_after(ring, i);
      // Second echoes and repeated points make gaps that are no steps.
      if (gap < 0.05 * nominal || gap > kGapSteps * nominal) continue;
      sum += gap;
      ++n;
    }
    if (n >= 100) steps.push_back(sum / double(n));
  }
  return steps.empty() ? nominal : median(steps);
}

// Finds the elevation of each ring, which decides whether its gaps count as misses.
std::vector<double> ring_elevations(const std::vector<Ring>& rings, const Sensor& sensor,
                                    double fault) {
  std::vector<double> measured(rings.size());
  std::vector<size_t> filled;
  for (size_t r = 0; r < rings.size(); ++r) {
    std::vector<double> elevations;
    for (const SensorRay& ray : rings[r]) elevations.push_back(ray.elevation_rad + fault);
    if (!elevations.empty()) filled.push_back(r);
    measured[r] = median(elevations);
  }
  const auto& c = sensor.channels;
  if (filled.empty()) return measured;
  const size_t a = filled.front(), b = filled.back();
  const bool same_sense =
      rings.size() == c.size() &&
      (measured[b] - measured[a]) * (c[b].elevation_rad - c[a].elevation_rad) >= 0;
  if (!same_sense) return measured;
  for (size_t r = 0; r < rings.size(); ++r) measured[r] = c[r].elevation_rad;
  return measured;
}

/// Decides which beams without a return are no misses.
class Unknown {
 public:
  Unknown(const std::vector<Ring>& rings, const std::vector<double>& elevations, double below_rad,
          double fault_rad, const Vec3& up, double step_rad)
      : rings_(rings),
        elevations_(elevations),
        below_rad_(below_rad),
        fault_rad_(fault_rad),
        up_(up),
        full_(2 * M_PI / step_rad) {}

  bool ray(size_t ring, const SensorRay& ray) const {
    if (up_.z() > kUpright) return elevations_[ring] < below_rad_;
    const Vec3 d = unit_vector(ray.azimuth_rad, ray.elevation_rad + fault_rad_);
    return std::asin(std::clamp(d.dot(up_), -1.0, 1.0)) < below_rad_;
  }
  // Whether a ring without any return can have seen the sky. It cannot where half of each
  // neighbour has returns, except above all rings that have some.
  bool silent(size_t ring) const {
    const double e = elevations_[ring];
    const Ring *above = nullptr, *below = nullptr;
    double above_rad = INFINITY, below_rad = -INFINITY;
    for (size_t r = 0; r < rings_.size(); ++r) {
      if (rings_[r].empty()) continue;
      if (elevations_[r] >= e && elevations_[r] < above_rad)
        above = &rings_[r], above_rad = elevations_[r];
      if (elevations_[r] < e && elevations_[r] > below_rad)
        below = &rings_[r], below_rad = elevations_[r];
    }
    const auto returns = [&](const Ring* r) { return !r || 2 * double(r->size()) > full_; };
    const bool to_sky =
        up_.z() > kUpright ? !above && e >= 0 : up_.z() < -kUpright && !below && e <= 0;
    return !to_sky && returns(above) && returns(below);
  }

 private:
  static constexpr double kUpright = 0.7;  // cosine
  const std::vector<Ring>& rings_;
  const std::vector<double>& elevations_;
  double below_rad_, fault_rad_;
  Vec3 up_;
  double full_;
};

// Computes the time of a miss, a fraction s of the way from a to b. If the scan begins and ends
// within the gap, times jump there, and each side continues at the pace of its own neighbour.
double time_between(const SensorRay& a, const SensorRay& b, double gap, double s, double pace) {
  const double expected = gap * pace;
  if (std::abs(b.time_s - a.time_s - expected) < 0.5 * std::abs(2 * M_PI * pace)) {
    return a.time_s + s * (b.time_s - a.time_s);
  }
  return s < 0.5 ? a.time_s + s * expected : b.time_s - (1 - s) * expected;
}

// The miss a fraction s of the way from one return of a ring to the next.
SensorRay miss_between(const SensorRay& a, const SensorRay& b, double gap, double s, double pace) {
  SensorRay miss;
  miss.place = a.place;
  miss.ring = a.ring;
  miss.azimuth_rad = a.azimuth_rad + s * gap;
  miss.elevation_rad = a.elevation_rad + s * (b.elevation_rad - a.elevation_rad);
  miss.time_s = time_between(a, b, gap, s, pace);
  return miss;
}

}  // namespace

std::vector<uint16_t> rings_from_order(const std::vector<Vec3f>& points) {
  std::vector<uint16_t> rings(points.size());
  uint16_t ring = 0;
  double before = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (kind_of(points[i], 0) == PointKind::kReturn) {
      const double azimuth = positive_angle(azimuth_of(points[i]));
      if (before - azimuth > M_PI) ++ring;
      before = azimuth;
    }
    rings[i] = ring;
  }
  return rings;
}

std::vector<uint16_t> rings_from_elevation(const std::vector<Vec3f>& points, const Sensor& sensor,
                                           double fault_rad) {
  std::vector<uint16_t> rings(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    if (kind_of(points[i], 0) != PointKind::kReturn) continue;
    const double elevation = elevation_of(points[i]) + fault_rad;
    const double r = points[i].cast<double>().norm();
    double best = INFINITY;
    for (size_t c = 0; c < sensor.channels.size(); ++c) {
      const Channel& channel = sensor.channels[c];
      const double e = channel.elevation_rad;
      const double seen = e + std::asin(std::clamp(channel.z_m * std::cos(e) / r, -1.0, 1.0));
      if (std::abs(elevation - seen) >= best) continue;
      best = std::abs(elevation - seen);
      rings[i] = uint16_t(c);
    }
  }
  return rings;
}

InsertedMisses insert_misses(std::vector<SensorRay>& rays, const Sensor& sensor,
                             double nominal_step_rad, double unknown_below_rad, const Vec3& up,
                             double fault_rad, double revolution_s, double time_s) {
  std::vector<Ring> rings(sensor.channels.size());
  for (const SensorRay& ray : rays) {
    if (ray.ring >= rings.size()) rings.resize(ray.ring + 1);
    rings[ray.ring].push_back(ray);
    rings[ray.ring].back().azimuth_rad = positive_angle(ray.azimuth_rad);
  }
  for (Ring& ring : rings) {
    std::stable_sort(ring.begin(), ring.end(), [](const SensorRay& a, const SensorRay& b) {
      return a.azimuth_rad < b.azimuth_rad;
    });
  }
  const double step = measured_step(rings, nominal_step_rad);
  const std::vector<double> elevations = ring_elevations(rings, sensor, fault_rad);
  const Unknown unknown(rings, elevations, unknown_below_rad, fault_rad, up, step);
  const double pace = sensor.turn() * revolution_s / (2 * M_PI);
  // A few rings may have seen only sky. If most are absent, the scan is not of this sensor.
  const auto filled = std::count_if(rings.begin(), rings.end(), [](auto& r) { return !r.empty(); });
  const bool whole_rings = 2 * size_t(filled) >= sensor.channels.size();
  InsertedMisses done;
  size_t gaps = 0, wide = 0;
  for (size_t r = 0; r < rings.size(); ++r) {
    const Ring& ring = rings[r];
    const bool silent = ring.empty() && unknown.silent(r);
    const auto insert = [&](const SensorRay& miss) {
      const bool left_out = silent || unknown.ray(r, miss);
      ++(left_out ? done.unknown : done.inserted);
      if (!left_out) rays.push_back(miss);
    };
    if (ring.empty()) {
      if (!whole_rings || r >= sensor.channels.size()) continue;
      SensorRay whole;
      whole.ring = uint16_t(r);
      whole.place = SensorRay::kInserted;
      whole.elevation_rad = sensor.channels[r].elevation_rad - fault_rad;
      whole.time_s = time_s;
      const size_t n = size_t(std::lround(2 * M_PI / step));
      for (size_t k = 0; k < n; ++k) {
        whole.azimuth_rad = step * double(k);
        insert(whole);
      }
      continue;
    }
    for (size_t i = 0; i < ring.size(); ++i) {
      const double gap = gap_after(ring, i);
      gaps += gap > 0.05 * step;
      if (gap <= kGapSteps * step) continue;
      ++wide;
      const size_t n = size_t(std::lround(gap / step)) - 1;
      const SensorRay& next = ring[(i + 1) % ring.size()];
      for (size_t k = 1; k <= n; ++k) {
        insert(miss_between(ring[i], next, gap, double(k) / double(n + 1), pace));
      }
    }
  }
  done.thinned = gaps >= 1000 && double(wide) > 0.4 * double(gaps);
  return done;
}

}  // namespace underbrush::sensor
