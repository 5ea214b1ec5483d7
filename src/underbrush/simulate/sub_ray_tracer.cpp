#include "underbrush/simulate/sub_ray_tracer.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/draw.hpp"

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

}  // namespace

TracedBeams::Beam TracedBeams::operator[](size_t beam) const {
  const size_t at = first_[beam], n = first_[beam + 1] - at;
  return {
      {&rays_[at], n}, {&met_[at], n}, {&keys_[at], n}, all_[beam] ? all_weight_ : probe_weight_};
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
  const size_t each = all_.size(), n = (end - begin) * each;
  out.rays_.resize(n);
  out.keys_.resize(n);
  out.met_.resize(n);
  out.first_.resize(end - begin + 1);
  out.all_.assign(end - begin, 1);
  out.all_weight_ = all_.weight();
  for (size_t i = begin, at = 0; i < end; ++i, at += each) {
    const uint64_t key = beam_key(seed_, beams.scan[i], first_beam + i);
    all_.spread(sensor::beam_axes(axis_of(beams, i, key)), &out.rays_[at]);
    out.first_[i - begin] = at;
    if (once_) {
      std::fill_n(&out.keys_[at], each, matter_at(matter_, beams.time_s[i], sway_s_));
    } else {
      all_.keys(key, &out.keys_[at]);
    }
  }
  out.first_.back() = n;
  world_.nearest_accepted(out.rays_, out.keys_, {&beams.time_s[begin], end - begin},
                          {std::max(beams.info.min_range_m, kLeastRangeM), beams.info.max_range_m},
                          out.met_);
  if (!once_) return;
  for (size_t b = 0, at = 0; b < end - begin; ++b, at += each) {
    key_matter(beams.time_s[begin + b], {&out.rays_[at], each}, {&out.keys_[at], each},
               {&out.met_[at], each});
  }
}

void SubRayTracer::trace_probes(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                                TracedBeams& out) const {
  const trace::RangeLimits limits{std::max(beams.info.min_range_m, kLeastRangeM),
                                  beams.info.max_range_m};
  const size_t n = end - begin, probes = probes_->size(), rest = rest_->size();
  if (!out.returns_) out.returns_ = std::make_unique<SubReturns>(probes);
  out.probe_rays_.resize(n * probes);
  out.probe_keys_.resize(n * probes);
  out.probe_met_.resize(n * probes);
  out.all_weight_ = all_.weight();
  out.probe_weight_ = probes_->weight();
  out.all_.assign(n, 0);
  out.first_.assign(n + 1, 0);
  out.time_s_.clear();
  const auto axes = [&](size_t b) {
    const size_t i = begin + b;
    return sensor::beam_axes(axis_of(beams, i, beam_key(seed_, beams.scan[i], first_beam + i)));
  };
  for (size_t b = 0; b < n; ++b) {
    probes_->spread(axes(b), &out.probe_rays_[b * probes]);
    std::fill_n(&out.probe_keys_[b * probes], probes,
                matter_at(matter_, beams.time_s[begin + b], sway_s_));
  }
  world_.nearest_accepted(out.probe_rays_, out.probe_keys_, {&beams.time_s[begin], n}, limits,
                          out.probe_met_);
  for (size_t b = 0; b < n; ++b) {
    out.all_[b] = !probes_agree(beams.time_s[begin + b], b * probes, limits, out);
    out.first_[b + 1] = out.first_[b] + probes + (out.all_[b] ? rest : 0);
    if (out.all_[b]) out.time_s_.push_back(beams.time_s[begin + b]);
  }
  // The rays that are still to be traced stand at the end, one beam after the other, and move to
  // their probes' beams afterwards.
  const size_t total = out.first_.back(), open = out.time_s_.size() * rest;
  out.rays_.resize(total + open);
  out.keys_.resize(total + open);
  out.met_.resize(total + open);
  for (size_t b = 0, at = total; b < n; ++b) {
    if (!out.all_[b]) continue;
    rest_->spread(axes(b), &out.rays_[at]);
    std::fill_n(&out.keys_[at], rest, matter_at(matter_, beams.time_s[begin + b], sway_s_));
    at += rest;
  }
  world_.nearest_accepted({out.rays_.data() + total, open}, {out.keys_.data() + total, open},
                          out.time_s_, limits, {out.met_.data() + total, open});
  for (size_t b = 0, at = total; b < n; ++b) {
    const size_t to = out.first_[b];
    std::copy_n(&out.probe_rays_[b * probes], probes, &out.rays_[to]);
    std::copy_n(&out.probe_keys_[b * probes], probes, &out.keys_[to]);
    std::copy_n(&out.probe_met_[b * probes], probes, &out.met_[to]);
    if (!out.all_[b]) continue;
    key_matter(beams.time_s[begin + b], {&out.rays_[at], rest}, {&out.keys_[at], rest},
               {&out.met_[at], rest});
    std::copy_n(&out.rays_[at], rest, &out.rays_[to + probes]);
    std::copy_n(&out.keys_[at], rest, &out.keys_[to + probes]);
    std::copy_n(&out.met_[at], rest, &out.met_[to + probes]);
    at += rest;
  }
  out.rays_.resize(total);
}

/// Keys sub-rays by the matter that they met, and leaves the sensor's noise to the receiver.
void SubRayTracer::key_matter(double time_s, std::span<const Ray> rays, std::span<uint64_t> keys,
                              std::span<trace::Intersection> met) const {
  for (size_t k = 0; k < rays.size(); ++k) {
    trace::Intersection& m = met[k];
    if (m.none()) continue;
    keys[k] =
        trace::instance_key(matter_, m.instance) ^ world_.grain_cell(rays[k], time_s, m, keys[k]);
    m.sigma_m = matter_sigma(m.sigma_m, world_.model(m.instance).range_noise_m);
  }
}

/// Keys the probes of a beam, which begin at `at`, and tells whether they speak for all.
bool SubRayTracer::probes_agree(double time_s, size_t at, const trace::RangeLimits& limits,
                                TracedBeams& out) const {
  const size_t n = probes_->size();
  const std::span<trace::Intersection> met{&out.probe_met_[at], n};
  const std::span<uint64_t> keys{&out.probe_keys_[at], n};
  key_matter(time_s, {&out.probe_rays_[at], n}, keys, met);
  out.returns_->collect(met, keys, probes_->weight(), limits);
  const std::span<const float> range_m = out.returns_->range_m();
  if (range_m.empty()) return true;
  if (range_m.size() < n) return false;
  const auto [near, far] = std::minmax_element(range_m.begin(), range_m.end());
  return double(*far) - double(*near) <= same_m_;
}

}  // namespace underbrush::simulate
