#include "underbrush/simulate/sub_ray_tracer.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/draw.hpp"
#include "underbrush/simulate/sub_returns.hpp"

namespace underbrush::simulate {
namespace {

using sensor::SubRay;

constexpr size_t kFewest = 26;  // sub-rays for which probes pay
constexpr size_t kProbes = 13;

/// Rotates a direction about the vertical.
Vec3 turned(double angle_rad, const Vec3& d) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * d.x() - s * d.y(), s * d.x() + c * d.y(), d.z()};
}

double distance2(const SubRay& a, const SubRay& b) {
  return double((a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v));
}

/// Moves probes to the front: the sub-ray that is nearest to the middle, then in turn the one that
/// is farthest from all before it.
std::vector<SubRay> probes_first(std::vector<SubRay> places) {
  for (size_t k = 0; k < kProbes; ++k) {
    const auto far_from_before = [&](const SubRay& p) {
      double least = k == 0 ? -distance2(p, {}) : INFINITY;
      for (size_t before = 0; before < k; ++before) {
        least = std::min(least, distance2(p, places[before]));
      }
      return least;
    };
    const auto best = std::max_element(
        places.begin() + std::ptrdiff_t(k), places.end(),
        [&](const SubRay& a, const SubRay& b) { return far_from_before(a) < far_from_before(b); });
    std::iter_swap(places.begin() + std::ptrdiff_t(k), best);
  }
  return places;
}

/// Gives the first places the energy of the sub-rays that are nearest to them.
std::vector<SubRay> probes_of(const std::vector<SubRay>& places) {
  std::vector<double> energy(kProbes);
  for (const SubRay& p : places) {
    size_t nearest = 0;
    for (size_t k = 1; k < kProbes; ++k) {
      if (distance2(p, places[k]) < distance2(p, places[nearest])) nearest = k;
    }
    energy[nearest] += double(p.weight);
  }
  std::vector<SubRay> probes(places.begin(), places.begin() + kProbes);
  const std::vector<float> weight = sensor::exact_weights(energy);
  for (size_t k = 0; k < kProbes; ++k) probes[k].weight = weight[k];
  return probes;
}

trace::RangeLimits limits_of(const BeamLog& beams) {
  return {std::max(beams.info.min_range_m, kLeastRangeM), beams.info.max_range_m};
}

}  // namespace

void TracedBeams::SubRays::resize(size_t n) {
  rays.resize(n);
  keys.resize(n);
  met.resize(n);
  range_m.resize(n);
}

void TracedBeams::SubRays::copy(size_t at, const SubRays& from, size_t begin, size_t count) {
  std::copy_n(&from.rays[begin], count, &rays[at]);
  std::copy_n(&from.met[begin], count, &met[at]);
  std::copy_n(&from.range_m[begin], count, &range_m[at]);
}

TracedBeams::Beam TracedBeams::operator[](size_t beam) const {
  const bool probes = place_[beam] == kProbesAlone;
  const std::span<const float> weight = probes ? probe_weight_ : all_weight_;
  const SubRays& of = probes ? probes_ : all_;
  const size_t n = weight.size(), at = n * (probes ? beam : place_[beam]);
  return {{&of.rays[at], n}, {&of.met[at], n}, {&of.range_m[at], n}, weight};
}

SubRayTracer::SubRayTracer(const DynamicWorld& world, const sensor::BeamShape& beam,
                           std::span<const SubRay> sub_rays, uint64_t seed, double same_m,
                           double sway_s)
    : world_(world),
      seed_(seed),
      matter_(matter_key(seed)),
      once_(world.world().draws() != trace::Draws::kAnew),
      encoder_step_rad_(beam.encoder_step_rad),
      same_m_(same_m),
      sway_s_(sway_s),
      all_(beam, sub_rays) {
  if (!once_ || same_m <= 0 || sub_rays.size() < kFewest) return;
  const std::vector<SubRay> places = probes_first({sub_rays.begin(), sub_rays.end()});
  all_ = SubRayBundle(beam, places);
  probes_ = std::make_unique<SubRayBundle>(beam, probes_of(places));
  rest_ = std::make_unique<SubRayBundle>(beam, std::span(places).subspan(kProbes));
}

/// The axis of a beam, off by a random angle within the encoder's step.
Ray SubRayTracer::axis_of(const BeamLog& beams, size_t i, uint64_t key) const {
  Ray axis = beams.ray(i);
  if (encoder_step_rad_ > 0) {
    const double off = uniform_from_bits(random_bits(key, 2, Purpose::kDirection)) - 0.5;
    axis.direction = turned(off * encoder_step_rad_, axis.direction);
  }
  return axis;
}

void SubRayTracer::trace(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                         TracedBeams& out) const {
  probes_ ? trace_probes(beams, first_beam, begin, end, out)
          : trace_all(beams, first_beam, begin, end, out);
}

void SubRayTracer::trace_all(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                             TracedBeams& out) const {
  const size_t each = all_.size(), n = end - begin;
  TracedBeams::SubRays& all = out.all_;
  all.resize(n * each);
  out.traced_ = n * each;
  out.all_weight_ = all_.weight();
  out.place_.resize(n);
  for (size_t b = 0; b < n; ++b) {
    const size_t i = begin + b, at = b * each;
    const uint64_t key = beam_key(seed_, beams.scan[i], first_beam + i);
    all_.spread(sensor::beam_axes(axis_of(beams, i, key)), &all.rays[at]);
    out.place_[b] = uint32_t(b);
    if (once_) {
      std::fill_n(&all.keys[at], each, matter_at(matter_, beams.time_s[i], sway_s_));
    } else {
      all_.keys(key, &all.keys[at]);
    }
  }
  find({&beams.time_s[begin], n}, limits_of(beams), out.matter_, all);
}

void SubRayTracer::trace_probes(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                                TracedBeams& out) const {
  const size_t n = end - begin, probes = probes_->size(), rest = rest_->size();
  const auto aim = [&](size_t b, const SubRayBundle& bundle, TracedBeams::SubRays& at, size_t k) {
    const size_t i = begin + b;
    const uint64_t key = beam_key(seed_, beams.scan[i], first_beam + i);
    bundle.spread(sensor::beam_axes(axis_of(beams, i, key)), &at.rays[k]);
    std::fill_n(&at.keys[k], bundle.size(), matter_at(matter_, beams.time_s[i], sway_s_));
  };
  out.all_weight_ = all_.weight();
  out.probe_weight_ = probes_->weight();
  out.probes_.resize(n * probes);
  for (size_t b = 0; b < n; ++b) aim(b, *probes_, out.probes_, b * probes);
  find({&beams.time_s[begin], n}, limits_of(beams), out.matter_, out.probes_);
  out.place_.assign(n, TracedBeams::kProbesAlone);
  out.time_s_.clear();
  for (size_t b = 0; b < n; ++b) {
    if (agree({&out.probes_.range_m[b * probes], probes})) continue;
    out.place_[b] = uint32_t(out.time_s_.size());
    out.time_s_.push_back(beams.time_s[begin + b]);
  }
  out.rest_.resize(out.time_s_.size() * rest);
  out.traced_ = out.probes_.size() + out.rest_.size();
  for (size_t b = 0; b < n; ++b) {
    if (out.place_[b] != TracedBeams::kProbesAlone) aim(b, *rest_, out.rest_, out.place_[b] * rest);
  }
  find(out.time_s_, limits_of(beams), out.matter_, out.rest_);
  out.all_.resize(out.time_s_.size() * (probes + rest));
  for (size_t b = 0; b < n; ++b) {
    if (out.place_[b] == TracedBeams::kProbesAlone) continue;
    const size_t to = out.place_[b] * (probes + rest);
    out.all_.copy(to, out.probes_, b * probes, probes);
    out.all_.copy(to + probes, out.rest_, out.place_[b] * rest, rest);
  }
}

/// Traces sub-rays, as many of each of the beams of these times, and draws their ranges. Where the
/// matter is drawn once, draws are keyed by the matter that was met, and the sensor's noise is left
/// to the receiver.
void SubRayTracer::find(std::span<const double> time_s, const trace::RangeLimits& limits,
                        MatterAt& matter, TracedBeams::SubRays& s) const {
  world_.nearest_accepted(s.rays, s.keys, time_s, limits, s.met);
  for (size_t b = 0; once_ && b < time_s.size(); ++b) {
    const size_t each = s.size() / time_s.size();
    for (size_t k = b * each; k < (b + 1) * each; ++k) {
      trace::Intersection& m = s.met[k];
      if (m.none()) continue;
      const double noise_m = matter.model(m, time_s[b]).range_noise_m;
      s.keys[k] =
          matter.key(matter_, m, time_s[b]) ^ matter.cell(s.rays[k], time_s[b], m, s.keys[k]);
      m.sigma_m = matter_sigma(m.sigma_m, noise_m);
    }
  }
  draw_ranges(s.met, limits, s.keys, s.range_m);
}

/// Whether the probes of a beam speak for all.
bool SubRayTracer::agree(std::span<const float> range_m) const {
  size_t missed = 0;
  float near = INFINITY, far = -INFINITY;
  for (const float r : range_m) {
    missed += std::isnan(r);
    near = std::min(near, r);
    far = std::max(far, r);
  }
  if (missed == range_m.size()) return true;
  return missed == 0 && double(far) - double(near) <= same_m_;
}

}  // namespace underbrush::simulate
