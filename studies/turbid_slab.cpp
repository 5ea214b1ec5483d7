#include "studies/turbid_slab.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::studies {
namespace {

constexpr double kTripodM[][2] = {{0, 0}, {7, 7}, {-7, 7}, {7, -7}, {-7, -7}};
constexpr double kTripodHeightM = 1.5, kLeastElevation = -50 * kDegree;

/// The radius of the beam a metre away, in radii of a leaf.
double widening(const TurbidSlab& slab) {
  return 0.5 * slab.divergence_rad / TurbidSlab::kLeafRadiusM;
}

/// Returns the range of the first leaf beyond `enter_m`: the nearest of three independent
/// processes, whose extinctions do not depend on the range, grow with it and with its square.
double first_leaf(const TurbidSlab& slab, const Ray& ray, double enter_m, Stream& random) {
  const auto exponential = [&](double rate) { return -std::log(random.uniform()) / rate; };
  const double w = widening(slab), density = slab.area_density;
  const double least = enter_m + exponential(density * projection(slab.angles, ray.direction));
  if (w == 0) return least;
  const double grows = std::sqrt(enter_m * enter_m + 2 * exponential(density * M_PI / 2 * w));
  const double squares = std::cbrt(std::pow(enter_m, 3) + 3 * exponential(density * w * w));
  return std::min({least, grows, squares});
}

/// Returns the range of a beam without noise.
double range_of(const TurbidSlab& slab, const Ray& ray, Stream& random) {
  if (const auto crossing = TurbidSlab::crossing(ray)) {
    const double leaf = first_leaf(slab, ray, crossing->enter_m, random);
    if (leaf < crossing->leave_m) return leaf;
  }
  return ray.direction.z() < 0 ? -ray.origin.z() / ray.direction.z() : INFINITY;
}

Vec3 direction_of(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

Vec3 tripod(size_t number) { return {kTripodM[number][0], kTripodM[number][1], kTripodHeightM}; }

LogInfo log_info() {
  LogInfo info;
  info.max_range_m = 60;
  info.has_misses = true;
  return info;
}

Ray view_ray(SlabView view, size_t number, Stream& random) {
  const double u = random.uniform(-1, 1);
  const double v = random.uniform(-1, 1);
  if (view == SlabView::kOverhead) return {Vec3(8 * u, 8 * v, 30), -Vec3::UnitZ()};
  if (view == SlabView::kMobile) {
    const double across = 45 * kDegree * u, tilt = 30 * kDegree;
    const Vec3 up(std::sin(tilt), 0, std::cos(tilt));
    return {Vec3(6 * (double(number % 3) - 1), 0, 2),
            std::cos(across) * up + std::sin(across) * Vec3::UnitY()};
  }
  return {tripod(number % std::size(kTripodM)), direction_of(M_PI * u, kDegree * (50 + 40 * v))};
}

}  // namespace

double projection(LeafAngles angles, const Vec3& direction) {
  const double cosine = std::min(1.0, std::abs(direction.z()));
  if (angles == LeafAngles::kHorizontal) return cosine;
  if (angles == LeafAngles::kVertical) return 2 / M_PI * std::sqrt(1 - cosine * cosine);
  return 0.5;
}

std::optional<SlabCrossing> TurbidSlab::crossing(const Ray& ray) {
  const Vec3 low(-kHalfWidthM, -kHalfWidthM, kLowM), high(kHalfWidthM, kHalfWidthM, kHighM);
  SlabCrossing out{0, INFINITY};
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < low[axis] || o > high[axis]) return std::nullopt;
      continue;
    }
    const double a = (low[axis] - o) / d, b = (high[axis] - o) / d;
    out.enter_m = std::max(out.enter_m, std::min(a, b));
    out.leave_m = std::min(out.leave_m, std::max(a, b));
  }
  if (!(out.enter_m < out.leave_m)) return std::nullopt;
  return out;
}

double TurbidSlab::optical_depth(const Ray& ray, double from_m, double to_m) const {
  const auto integral = [&](double s) {
    const double w = widening(*this) * s;
    return s * (projection(angles, ray.direction) + M_PI / 4 * w + w * w / 3);
  };
  return area_density * (integral(to_m) - integral(from_m));
}

BeamLog measured(const TurbidSlab& slab, BeamLog beams, uint64_t seed) {
  require(slab.divergence_rad == 0 || slab.angles == LeafAngles::kSpherical,
          "slab: beams widen among spherical leaves only");
  constexpr float kIntensity = 128;
  for (size_t i = 0; i < beams.size(); ++i) {
    Stream random(beam_key(seed, beams.scan[i], i));
    const double range = range_of(slab, beams.ray(i), random);
    const bool hit = range < beams.info.max_range_m;
    beams.range_m[i] = hit ? float(range + TurbidSlab::kNoiseM * random.normal()) : kMiss;
    beams.intensity[i] = hit ? kIntensity : 0;
  }
  return beams;
}

double area_density_of_voxels(const TurbidSlab& slab) {
  double gap = 0;
  for (int axis = 0; axis < 3; ++axis) {
    gap += std::exp(-slab.area_density * projection(slab.angles, Vec3::Unit(axis))) / 3;
  }
  return -2 * std::log(gap);
}

BeamLog tripod_beams(double step_rad) {
  const size_t columns = size_t(std::lround(2 * M_PI / step_rad));
  const size_t rings = size_t(std::ceil((M_PI / 2 - kLeastElevation) / step_rad - 1e-9));
  BeamLog out;
  out.info = log_info();
  out.resize(std::size(kTripodM) * columns * rings);
  for (size_t i = 0; i < out.size(); ++i) {
    const size_t ring = i % rings, column = i / rings, scan = column / columns;
    out.origin[i] = tripod(scan);
    out.direction[i] =
        direction_of(step_rad * double(column % columns), kLeastElevation + step_rad * double(ring))
            .cast<float>();
    out.time_s[i] = 1e-5 * double(i);
    out.ring[i] = uint16_t(ring);
    out.scan[i] = uint32_t(scan);
    out.packet[i] = uint32_t(column);
  }
  for (size_t k = 0; k < std::size(kTripodM); ++k) {
    const double time = 1e-5 * double(k * columns * rings);
    out.info.scans.push_back({uint32_t(k), time, {Eigen::Quaterniond::Identity(), tripod(k)}});
  }
  return out;
}

BeamLog view_beams(SlabView view, size_t beams, uint64_t seed) {
  BeamLog out;
  out.info = log_info();
  out.resize(beams);
  for (size_t i = 0; i < beams; ++i) {
    Stream random(beam_key(seed, uint64_t(view), i));
    const Ray ray = view_ray(view, i, random);
    out.origin[i] = ray.origin;
    out.direction[i] = ray.direction.cast<float>();
    out.time_s[i] = 1e-5 * double(i);
    out.packet[i] = uint32_t(i);
  }
  return out;
}

Transmission true_transmission(const TurbidSlab& slab, const BeamLog& beams) {
  double sum = 0, variance = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    const Ray ray = beams.ray(i);
    const auto crossing = TurbidSlab::crossing(ray);
    const double passes =
        crossing ? std::exp(-slab.optical_depth(ray, crossing->enter_m, crossing->leave_m)) : 1;
    sum += passes;
    variance += passes * (1 - passes);
  }
  const double n = double(beams.size());
  return {sum / n, std::sqrt(variance) / n};
}

double transmission_of(const BeamLog& answered) {
  size_t passed = 0;
  for (size_t i = 0; i < answered.size(); ++i) {
    passed += !answered.is_hit(i) || answered.end_point(i).z() < TurbidSlab::kLowM / 2;
  }
  return double(passed) / double(answered.size());
}

}  // namespace underbrush::studies
