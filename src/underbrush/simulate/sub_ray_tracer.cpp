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
constexpr double kPlaneShare = 0.1;  // of `same_m`: how far probes are off one plane

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
  const auto [kind, number] = place_[beam];
  const bool is_all = kind == Place::Kind::kAll, is_plane = kind == Place::Kind::kPlane;
  const SubRays& of = is_all ? all_ : probes_;
  const size_t n = is_all ? all_weight_.size() : probe_weight_.size();
  const size_t at = n * (is_all ? number : beam);
  Beam b{{&of.rays[at], n}, {&of.met[at], n}, {&of.range_m[at], n}, probe_weight_, {}};
  if (is_all || is_plane) b.weight = all_weight_;
  if (is_plane) {
    const size_t all = all_weight_.size();
    b.range_m = {&plane_m_[all * number], all};
    b.traced = nearest_probe_;
  }
  return b;
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
  plane_ = std::make_unique<ProbePlane>(beam, places, kProbes);
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
    out.place_[b] = {TracedBeams::Place::Kind::kAll, uint32_t(b)};
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
  const trace::RangeLimits limits = limits_of(beams);
  const auto is_all = [&](size_t b) {
    return out.place_[b].kind == TracedBeams::Place::Kind::kAll;
  };
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
  find({&beams.time_s[begin], n}, limits, out.matter_, out.probes_);
  using Kind = TracedBeams::Place::Kind;
  out.nearest_probe_ = plane_->nearest();
  out.place_.assign(n, {});
  out.time_s_.clear();
  out.plane_m_.resize(n * (probes + rest));
  uint32_t planes = 0;
  for (size_t b = 0; b < n; ++b) {
    switch (look({&out.probes_.range_m[b * probes], probes}, limits,
                 {&out.plane_m_[planes * (probes + rest)], probes + rest})) {
      case Kind::kProbes:
        break;
      case Kind::kPlane:
        out.place_[b] = {Kind::kPlane, planes++};
        lend_returns(b, out.probes_);
        break;
      case Kind::kAll:
        out.place_[b] = {Kind::kAll, uint32_t(out.time_s_.size())};
        out.time_s_.push_back(beams.time_s[begin + b]);
    }
  }
  out.rest_.resize(out.time_s_.size() * rest);
  out.traced_ = out.probes_.size() + out.rest_.size();
  for (size_t b = 0; b < n; ++b) {
    if (is_all(b)) aim(b, *rest_, out.rest_, out.place_[b].number * rest);
  }
  find(out.time_s_, limits, out.matter_, out.rest_);
  out.all_.resize(out.time_s_.size() * (probes + rest));
  for (size_t b = 0; b < n; ++b) {
    if (!is_all(b)) continue;
    const uint32_t number = out.place_[b].number;
    const size_t to = number * (probes + rest);
    out.all_.copy(to, out.probes_, b * probes, probes);
    out.all_.copy(to + probes, out.rest_, number * rest, rest);
  }
}

/// Gives the probes of a beam that met nothing what the nearest one with a return met, for the
/// sub-rays beside them that do meet the plane.
void SubRayTracer::lend_returns(size_t beam, TracedBeams::SubRays& probes) const {
  const size_t n = probes_->size(), at = beam * n;
  const std::span<const float> range_m(&probes.range_m[at], n);
  for (uint32_t k = 0; k < n; ++k) {
    if (std::isnan(range_m[k]))
      probes.met[at + k] = probes.met[at + plane_->nearest_return(k, range_m)];
  }
}

/// Draws where each of some beams ends in unknown space, on the way of its first sub-ray, and ends
/// the others there, too.
void SubRayTracer::end_in_unknown(size_t beams, const trace::RangeLimits& limits,
                                  TracedBeams::SubRays& s) const {
  const trace::UnknownSpace* unknown = world_.world().unknown_space();
  for (size_t b = 0; unknown && b < beams; ++b) {
    const size_t each = s.size() / beams;
    const auto met = std::span(s.met).subspan(b * each, each);
    double farthest = 0;
    for (const trace::Intersection& m : met) {
      farthest = std::max(farthest, m.none() ? limits.max_m : m.t_m);
    }
    const uint64_t key = once_ ? matter_ : s.keys[b * each];
    const auto end = unknown->drawn_end(s.rays[b * each], key, {limits.min_m, farthest});
    for (trace::Intersection& m : met) {
      if (end && (m.none() || m.t_m > *end)) m = {*end, 0, 0, 1, trace::kUnknown, 0};
    }
  }
}

/// Traces sub-rays, as many of each of the beams of these times, and draws their ranges. Where the
/// matter is drawn once, draws are keyed by the matter that was met, and the sensor's noise is left
/// to the receiver.
void SubRayTracer::find(std::span<const double> time_s, const trace::RangeLimits& limits,
                        MatterAt& matter, TracedBeams::SubRays& s) const {
  world_.nearest_accepted(s.rays, s.keys, time_s, limits, s.met);
  end_in_unknown(time_s.size(), limits, s);
  for (size_t b = 0; once_ && b < time_s.size(); ++b) {
    const size_t each = s.size() / time_s.size();
    for (size_t k = b * each; k < (b + 1) * each; ++k) {
      trace::Intersection& m = s.met[k];
      if (m.none() || m.element == trace::kUnknown) continue;
      const double noise_m = matter.model(m, time_s[b]).range_noise_m;
      s.keys[k] =
          matter.key(matter_, m, time_s[b]) ^ matter.cell(s.rays[k], time_s[b], m, s.keys[k]);
      m.sigma_m = matter_sigma(m.sigma_m, noise_m);
    }
  }
  draw_ranges(s.met, limits, s.keys, s.range_m);
}

/// Returns whether the probes of a beam stand for all sub-rays, and the ranges of all of them if
/// the probes lie on a plane.
TracedBeams::Place::Kind SubRayTracer::look(std::span<const float> probe_m,
                                            const trace::RangeLimits& limits,
                                            std::span<float> plane_m) const {
  using Kind = TracedBeams::Place::Kind;
  size_t missed = 0;
  float near = INFINITY, far = -INFINITY;
  for (const float r : probe_m) {
    missed += std::isnan(r);
    near = std::min(near, r);
    far = std::max(far, r);
  }
  const bool is_same = missed == 0 && double(far) - double(near) <= same_m_;
  if (is_same || missed == probe_m.size()) return Kind::kProbes;
  return plane_->fill(probe_m, kPlaneShare * same_m_, limits, plane_m) ? Kind::kPlane : Kind::kAll;
}

}  // namespace underbrush::simulate
