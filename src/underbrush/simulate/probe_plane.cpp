#include "underbrush/simulate/probe_plane.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/core/clones.hpp"

namespace underbrush::simulate {
namespace {

constexpr size_t kLeastReturns = 5;  // two more than a plane always has

/// A plane n·x = 1, and the limits of ranges.
struct Plane {
  float x, y, z, least_m, most_m;
};

/// Computes the ranges at which rays meet a plane, NaN beyond the limits or where the plane is
/// behind. Returns how many are too near.
UNDERBRUSH_CLONES int32_t ranges(size_t n, const Plane& p, const float* __restrict ox,
                                 const float* __restrict oy, const float* __restrict oz,
                                 const float* __restrict dx, const float* __restrict dy,
                                 const float* __restrict dz, const float* __restrict off,
                                 const uint32_t* __restrict nearest, float* __restrict out) {
  int32_t near = 0;
  for (size_t k = 0; k < n; ++k) {
    const float slope = p.x * dx[k] + (p.y * dy[k] + p.z * dz[k]);
    const float r = (1 - (p.x * ox[k] + (p.y * oy[k] + p.z * oz[k]))) / slope + off[nearest[k]];
    const bool is_met = (slope > 0) & (r <= p.most_m);
    near += int32_t(is_met & (r < p.least_m));
    out[k] = is_met ? r : NAN;
  }
  return near;
}

}  // namespace

ProbePlane::ProbePlane(const sensor::BeamShape& shape, std::span<const sensor::SubRay> places,
                       size_t probes)
    : probes_(probes) {
  require(probes > 0 && probes <= kMostProbes && probes <= places.size(),
          "probe plane: so many probes are not possible");
  const sensor::RayMaker maker(shape);
  const sensor::BeamAxes axes{{Vec3::Zero(), Vec3::UnitX()}, Vec3::UnitY(), Vec3::UnitZ(), {}};
  const auto distance2 = [&](size_t a, size_t b) {
    const float u = places[a].u - places[b].u, v = places[a].v - places[b].v;
    return u * u + v * v;
  };
  std::vector<uint32_t> order(probes);
  for (size_t k = 0; k < places.size(); ++k) {
    ray_.push_back(maker.ray(axes, double(places[k].u), double(places[k].v)));
    for (size_t c = 0; c < 3; ++c) {
      origin_[c].push_back(float(ray_[k].origin[Eigen::Index(c)]));
      direction_[c].push_back(float(ray_[k].direction[Eigen::Index(c)]));
    }
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return distance2(a, k) < distance2(b, k); });
    nearest_.push_back(order[0]);
    if (k < probes) by_distance_.insert(by_distance_.end(), order.begin(), order.end());
  }
}

uint32_t ProbePlane::nearest_return(uint32_t probe, std::span<const float> probe_m) const {
  const auto first = by_distance_.begin() + std::ptrdiff_t(probe * probes_);
  return *std::find_if(first, first + std::ptrdiff_t(probes_),
                       [&](uint32_t k) { return !std::isnan(probe_m[k]); });
}

bool ProbePlane::fill(std::span<const float> probe_m, double most_off_m,
                      const trace::RangeLimits& limits, std::span<float> range_m) const {
  Mat3 squares = Mat3::Zero();
  Vec3 sum = Vec3::Zero();
  size_t returned = 0;
  for (size_t k = 0; k < probes_; ++k) {
    if (std::isnan(probe_m[k])) continue;
    const double inverse = 1 / double(probe_m[k]);
    const Vec3 at = ray_[k].direction + inverse * ray_[k].origin;
    squares.noalias() += at * at.transpose();
    sum += inverse * at;
    ++returned;
  }
  if (returned < kLeastReturns) return false;
  const Vec3 normal = squares.inverse() * sum;
  std::array<float, kMostProbes> off{};
  for (size_t k = 0; k < probes_; ++k) {
    const double slope = normal.dot(ray_[k].direction);
    const double range = (1 - normal.dot(ray_[k].origin)) / slope;
    if (std::isnan(probe_m[k])) {
      if (!(slope <= 0 || range > limits.max_m)) return false;
      continue;
    }
    const double is_off = double(probe_m[k]) - range;
    if (!(slope > 0 && std::abs(is_off) <= most_off_m)) return false;
    off[k] = float(is_off);
  }
  for (uint32_t k = 0; returned < probes_ && k < probes_; ++k) {
    off[k] = off[nearest_return(k, probe_m)];
  }
  const Vec3f n = normal.cast<float>();
  return ranges(range_m.size(), {n.x(), n.y(), n.z(), float(limits.min_m), float(limits.max_m)},
                origin_[0].data(), origin_[1].data(), origin_[2].data(), direction_[0].data(),
                direction_[1].data(), direction_[2].data(), off.data(), nearest_.data(),
                range_m.data()) == 0;
}

}  // namespace underbrush::simulate
