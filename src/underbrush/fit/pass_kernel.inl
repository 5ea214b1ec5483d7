// The inner loops of a pass, eight meetings at a time. pass_kernel_*.cpp use this file, each for
// one instruction set. There is no fused multiplication and no approximate operation in it.
#pragma once
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <initializer_list>

#include "underbrush/fit/pass_kernel.hpp"

namespace underbrush::fit {
namespace {

constexpr size_t kLanes = 8;
typedef float F __attribute__((vector_size(32)));
typedef int32_t I __attribute__((vector_size(32)));
typedef double D __attribute__((vector_size(64)));
typedef int64_t L __attribute__((vector_size(64)));

constexpr float kNegligible = 1e-7f;  // a share of a beam too small to count
constexpr float kRootTwoPi = 2.50662827f;

inline F all(float x) { return F{x, x, x, x, x, x, x, x}; }
inline F pick(I mask, F yes, F no) { return (F)((mask & (I)yes) | (~mask & (I)no)); }

inline F root(F a) {
#if defined(__AVX2__)
  return (F)_mm256_sqrt_ps((__m256)a);
#elif defined(__SSE2__)
  __m128 half[2];
  __builtin_memcpy(half, &a, sizeof a);
  for (__m128& h : half) h = _mm_sqrt_ps(h);
  F r;
  __builtin_memcpy(&r, half, sizeof r);
  return r;
#else
  F r;
  for (size_t k = 0; k < kLanes; ++k) r[k] = __builtin_sqrtf(a[k]);
  return r;
#endif
}

// Computes eˣ for x ≤ 0 with a relative error of about 1e-6.
inline F exp_below_zero(F x) {
  x = pick(x > all(-80.0f), x, all(-80.0f));
  const F rounded = x * 1.44269504f + 12582912.0f, k = rounded - 12582912.0f;
  const F r = (x - k * 0.693359375f) + k * 2.12194440e-4f;
  F series = all(1.0f / 720);
  for (const float term : {1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) {
    series = series * r + term;
  }
  return (F)((I)series + ((I)rounded << 23));
}

// 1 − e^{−a}, without cancellation.
inline F opacity(F depth, F through) {
  const F series = depth * (1.0f - depth * (0.5f - depth * (1.0f / 6)));
  return pick(depth < all(0.02f), series, 1.0f - through);
}

struct Rays {
  F o[3], d[3];
};

// The closest approach of rays to Gaussians: its range t, σ, the whitened direction n of length 1
// and the whitened point of closest approach c.
struct Approach {
  F t, sigma, n[3], c[3];
};

inline Approach approach_of(const Rays& r, const F mean[3], const F w[6]) {
  F v[3], q[3];
  for (int k = 0; k < 3; ++k) v[k] = mean[k] - r.o[k];
  const F t0 = v[0] * r.d[0] + v[1] * r.d[1] + v[2] * r.d[2];
  for (int k = 0; k < 3; ++k) q[k] = v[k] - t0 * r.d[k];
  const F a[3] = {w[0] * r.d[0], w[1] * r.d[0] + w[2] * r.d[1],
                  w[3] * r.d[0] + w[4] * r.d[1] + w[5] * r.d[2]};
  const F b[3] = {w[0] * q[0], w[1] * q[0] + w[2] * q[1], w[3] * q[0] + w[4] * q[1] + w[5] * q[2]};
  Approach out;
  out.sigma = 1.0f / root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (int k = 0; k < 3; ++k) out.n[k] = a[k] * out.sigma;
  const F along = out.n[0] * b[0] + out.n[1] * b[1] + out.n[2] * b[2];
  out.t = t0 + along * out.sigma;
  for (int k = 0; k < 3; ++k) out.c[k] = along * out.n[k] - b[k];
  return out;
}

// The columns of eight meetings that are being collected.
struct Collected {
  float o[3][kLanes], d[3][kLanes], range[kLanes], reach[kLanes];
  float mean[3][kLanes], whiten[6][kLanes], opacity[kLanes], p[kLanes];
  uint32_t place[kLanes];
  size_t count = 0;
};

inline F load(const float* from) {
  F f;
  __builtin_memcpy(&f, from, sizeof f);
  return f;
}

void approach_ellipsoids(const ModelForm& m, const Collected& in, const MeetingColumns& out) {
  Rays r;
  F mean[3], whiten[6];
  for (int k = 0; k < 3; ++k) {
    r.o[k] = load(in.o[k]);
    r.d[k] = load(in.d[k]);
    mean[k] = load(in.mean[k]);
  }
  for (int k = 0; k < 6; ++k) whiten[k] = load(in.whiten[k]);
  const Approach a = approach_of(r, mean, whiten);
  const F delta2 = a.c[0] * a.c[0] + a.c[1] * a.c[1] + a.c[2] * a.c[2];
  const F per_m = load(in.opacity), depth = per_m * a.sigma * exp_below_zero(-0.5f * delta2);
  const F along = opacity(depth, exp_below_zero(-depth));
  const I inside = (delta2 <= all(m.tau2)) & (a.t >= all(m.min_range_m)) & (a.t <= load(in.reach)) &
                   (a.t - kFarthestMisfit * a.sigma <= load(in.range));
  const F p = pick(inside, pick(per_m > all(0), along, load(in.p)), all(-1));
  for (size_t k = 0; k < in.count; ++k) {
    const uint32_t at = in.place[k];
    out.t_m[at] = a.t[k];
    out.sigma_m[at] = a.sigma[k];
    out.p[at] = p[k];
  }
}

inline void collect(const ListedBeam& b, const EllipsoidForm& e, size_t place, Collected& c) {
  const size_t k = c.count++;
  for (int i = 0; i < 3; ++i) {
    c.o[i][k] = b.origin[i];
    c.d[i][k] = b.direction[i];
    c.mean[i][k] = e.mean[i];
  }
  for (int i = 0; i < 6; ++i) c.whiten[i][k] = e.whiten[i];
  c.range[k] = b.range_m;
  c.reach[k] = b.reach_m;
  c.opacity[k] = e.opacity_per_m;
  c.p[k] = e.p;
  c.place[k] = uint32_t(place);
}

void approach(const ModelForm& m, const ListedBeam* beams, const uint32_t* first, size_t beam,
              size_t beam_end, const uint32_t* met, const TriangleMeeting* on_triangle,
              const MeetingColumns& out) {
  const size_t begin = first[beam], count = first[beam_end] - begin;
  Collected c{};
  for (size_t b = beam; b < beam_end; ++b) {
    for (size_t s = first[b]; s < first[b + 1]; ++s) {
      const size_t at = s - begin;
      out.density[at] = beams[b].range_m;
      if (met[s] >= m.triangles) {
        collect(beams[b], m.ellipsoids[met[s] - m.triangles], at, c);
        if (c.count < kLanes) continue;
        approach_ellipsoids(m, c, out);
        c.count = 0;
        continue;
      }
      const size_t mesh = met[s] >= m.ground_triangles;
      const auto [t, tilt] = *on_triangle++;
      out.t_m[at] = t;
      out.sigma_m[at] = __builtin_sqrtf(m.range_variance[mesh] + m.roughness_variance[mesh] * tilt);
      const bool inside = t >= m.min_range_m && t <= beams[b].reach_m;
      out.p[at] = inside ? m.triangle_p[met[s]] : -1;
    }
  }
  if (c.count) approach_ellipsoids(m, c, out);
  for (size_t k = 0; k < count; k += kLanes) {
    const F sigma = load(out.sigma_m + k), x = (load(out.density + k) - load(out.t_m + k)) / sigma;
    const I near = (x < all(kFarthestMisfit)) & (x > all(-kFarthestMisfit));
    const F y = pick(near, x, all(0));
    const F density = pick(near, exp_below_zero(-0.5f * y * y) / (sigma * kRootTwoPi), all(0));
    __builtin_memcpy(out.density + k, &density, sizeof density);
  }
}

// Exact sums of eight terms at a time, in fixed point: added to `kShift`, a double has the term in
// its low bits.
class LaneSums {
 public:
  void add(size_t field, F term) {
    term = pick(term < all(1e4f), term, all(1e4f));
    term = pick(term > all(-1e4f), term, all(-1e4f));
    const D shifted = __builtin_convertvector(term, D) + kShift;
    sums_[field] += (L)shifted;
  }
  void count() { ++additions_; }
  void store(int64_t* sums) const {
    const int64_t each = __builtin_bit_cast(int64_t, kShift);
    for (size_t f = 0; f < kSumFields; ++f) {
      uint64_t sum = 0;
      for (size_t k = 0; k < kLanes; ++k) sum += uint64_t(sums_[f][k]);
      sums[f] += int64_t(sum - uint64_t(each) * kLanes * additions_);
    }
  }

 private:
  static constexpr double kShift = 0x1.8p26;  // 1.5 · 2⁵², times 2⁻²⁶
  L sums_[kSumFields] = {};
  uint64_t additions_ = 0;
};

// The shares of eight meetings, zero in lanes that are not used.
struct Shares {
  F range, hit, pass, loss;
};

// Adds the derivatives of the beams' log-likelihood by ln κ, s and E. The optical depth a = κ √(2π)
// σ e^{−δ²/2} changes by
//   ∂ ln a = k + c·s + nᵀEn + cᵀEc
// with the whitened direction n and the whitened point of closest approach c. The misfit x = (z −
// t)/σ changes by ∂x = −n·s − 2 nᵀEc − x nᵀEn, and σ by ∂ ln σ = nᵀEn. The log-likelihood of the
// beam is r [ln(1 − e^{−a}) − ln σ − x²/2] − (the share that went through) a.
inline void add_eight(const EllipsoidForm& e, const Rays& r, const Shares& s, LaneSums& sums) {
  const F mean[3] = {all(e.mean[0]), all(e.mean[1]), all(e.mean[2])};
  const F whiten[6] = {all(e.whiten[0]), all(e.whiten[1]), all(e.whiten[2]),
                       all(e.whiten[3]), all(e.whiten[4]), all(e.whiten[5])};
  const Approach a = approach_of(r, mean, whiten);
  const F* const n = a.n;
  const F* const c = a.c;
  const F delta2 = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
  F depth = e.opacity_per_m * a.sigma * exp_below_zero(-0.5f * delta2);
  depth = pick(depth > all(1e-20f), depth, all(1e-20f));
  const F through = exp_below_zero(-depth);
  // `odds` is a / (eᵃ − 1); odds × a is the Fisher information in ln a of a trial with p = 1 − e⁻ᵃ.
  const F odds = depth * through / opacity(depth, through);
  const F slope = s.hit * odds - s.pass * depth, weight = (s.hit + s.pass) * odds * depth;
  const F x = pick(s.hit >= all(kNegligible), (s.range - a.t) / a.sigma, all(0));
  sums.count();
  sums.add(kHits, s.hit);
  sums.add(kPasses, s.pass);
  sums.add(kLoss, s.hit * s.loss);
  sums.add(kDensitySlope, slope);
  sums.add(kDensityCurvature, weight);
  for (size_t k = 0; k < 3; ++k) sums.add(kShiftSlope + k, slope * c[k] + s.hit * x * n[k]);
  constexpr int kRow[6] = {0, 0, 0, 1, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 2};
  for (size_t k = 0; k < 6; ++k) {
    const int i = kRow[k], j = kColumn[k];
    const F nn = n[i] * n[j], cc = c[i] * c[j], nc = n[i] * c[j] + c[i] * n[j], both = nn + cc;
    const F xx = x * x;
    sums.add(kShiftCurvature + k, weight * cc + s.hit * nn);
    sums.add(kStretchSlope + k, slope * both + s.hit * ((xx - 1.0f) * nn + x * nc));
    sums.add(kStretchCurvature + k, weight * both * both + s.hit * (nc * nc + 2.0f * nn * nn));
    sums.add(kAlong + k, s.hit * xx * nn);
  }
}

void add(const EllipsoidForm& e, const ListedBeam* beams, const ElementMeeting* list, size_t count,
         const ShareColumns& shares, int64_t* out) {
  LaneSums sums;
  for (size_t next = 0; next < count;) {
    float column[10][kLanes] = {};
    size_t lanes = 0;
    for (; next < count && lanes < kLanes; ++next) {
      const uint32_t slot = list[next].slot;
      const float hit = shares.hit[slot], pass = shares.pass[slot];
      if (hit < kNegligible && pass < kNegligible) continue;
      const ListedBeam& b = beams[list[next].beam];
      for (int k = 0; k < 3; ++k) {
        column[k][lanes] = b.origin[k];
        column[3 + k][lanes] = b.direction[k];
      }
      column[6][lanes] = b.range_m;
      column[7][lanes] = hit;
      column[8][lanes] = pass;
      column[9][lanes] = shares.loss[list[next].beam];
      ++lanes;
    }
    if (lanes == 0) break;
    for (size_t k = lanes; k < kLanes; ++k) {  // lanes without a share repeat the first ray
      for (int c = 0; c < 6; ++c) column[c][k] = column[c][0];
    }
    const Rays r{{load(column[0]), load(column[1]), load(column[2])},
                 {load(column[3]), load(column[4]), load(column[5])}};
    add_eight(e, r, {load(column[6]), load(column[7]), load(column[8]), load(column[9])}, sums);
  }
  sums.store(out);
}

}  // namespace
}  // namespace underbrush::fit
