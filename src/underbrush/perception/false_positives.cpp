#include "underbrush/perception/false_positives.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::perception {
namespace {

/// A ghost's random numbers, by what they are for.
enum Draw : uint32_t {
  kLife,
  kRange,
  kBearing,
  kLength,
  kWidth,
  kHeight,
  kDriftX,
  kDriftY,
  kDraws
};

double uniform(uint64_t key, uint32_t element) {
  return uniform_from_bits(random_bits(key, element, Purpose::kPlace));
}

// The number of events of a Poisson process, by inversion of the distribution.
uint32_t poisson(double mean, double u) {
  double p = std::exp(-mean), sum = p;
  uint32_t k = 0;
  while (u > sum && k < 1000) {
    p *= mean / ++k;
    sum += p;
  }
  return k;
}

}  // namespace

void FalsePositiveOptions::check() const {
  require(rate_per_s >= 0 && mean_life_s > 0, "false positives: rate or life out of range");
  require(least_range_m > 0 && most_range_m >= least_range_m,
          "false positives: ranges out of order");
  require(least_size_m.minCoeff() > 0 && (most_size_m - least_size_m).minCoeff() >= 0,
          "false positives: sizes out of order");
  require(drift_m_s >= 0 && field_rad > 0, "false positives: drift or field out of range");
}

FalsePositives::FalsePositives(const FalsePositiveOptions& options, uint64_t seed)
    : options_(options), seed_(seed) {
  options_.check();
}

void FalsePositives::reset() {
  ghosts_.clear();
  cycle_ = next_ = 0;
  last_s_ = 0;
}

void FalsePositives::add(const ObjectList& list, uint64_t key, uint32_t k) {
  const auto draw = [&](Draw what) { return uniform(key, 1 + k * kDraws + what); };
  const auto between = [&](Draw what, double low, double high) {
    return low + (high - low) * draw(what);
  };
  Ghost g;
  g.end_s = list.time_s - options_.mean_life_s * std::log(draw(kLife));
  TrackedObject& o = g.object;
  o.id = kFirstGhost + next_++;
  o.label = ObjectClass::kUnknown;
  o.probability[size_t(ObjectClass::kOther)] = 1;
  const double range = between(kRange, options_.least_range_m, options_.most_range_m);
  const double bearing = (draw(kBearing) - 0.5) * options_.field_rad;
  for (int axis = 0; axis < 3; ++axis) {
    o.box.size_m[axis] =
        between(Draw(kLength + axis), options_.least_size_m[axis], options_.most_size_m[axis]);
  }
  o.box.centre_m = list.world_from_vehicle *
                   Vec3(range * std::cos(bearing), range * std::sin(bearing), o.box.size_m.z() / 2);
  o.velocity_m_s = {options_.drift_m_s * normal_from_uniform(draw(kDriftX)),
                    options_.drift_m_s * normal_from_uniform(draw(kDriftY)), 0};
  o.measured_size_m = o.box.size_m;
  o.reference_m = o.box.centre_m;
  o.existence = 0.5;
  o.is_measured = true;
  ghosts_.push_back(g);
}

void FalsePositives::step(ObjectList& list) {
  const double time_s = cycle_ ? std::max(list.time_s - last_s_, 0.0) : 0;
  const uint64_t key = beam_key(seed_, cycle_++, 0);
  last_s_ = list.time_s;
  std::erase_if(ghosts_, [&](const Ghost& g) { return g.end_s <= list.time_s; });
  for (Ghost& g : ghosts_) {
    g.object.box.centre_m += time_s * g.object.velocity_m_s;
    g.object.reference_m = g.object.box.centre_m;
    g.object.age_s += time_s;
  }
  const uint32_t born = poisson(options_.rate_per_s * time_s, uniform(key, 0));
  for (uint32_t k = 0; k < born; ++k) add(list, key, k);
  for (const Ghost& g : ghosts_) list.objects.push_back(g.object);
}

}  // namespace underbrush::perception
