// The inner loops of a pass, eight meetings at a time. pass_kernel_*.cpp use this file, each for
// one instruction set. There is no fused multiplication and no approximate operation in it.
#pragma once
#include "underbrush/core/eight_lanes.inl"
#include "underbrush/likelihood/pass_kernel.hpp"

namespace underbrush::likelihood {
namespace {

constexpr float kNegligible = 1e-7f;  // a share of a beam too small to count
constexpr float kRootTwoPi = 2.50662827f;

// 1 − e^{−a}, without cancellation.
inline F opacity(F depth, F through) {
  const F series = depth * (1.0f - depth * (0.5f - depth * (1.0f / 6)));
  return pick(depth < all(0.02f), series, 1.0f - through);
}

// Transposes eight rows of eight numbers.
inline void transpose(L x[8]) {
  L a[8], b[8];
  for (int k = 0; k < 8; k += 2) {
    a[k] = __builtin_shufflevector(x[k], x[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    a[k + 1] = __builtin_shufflevector(x[k], x[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int k = 0; k < 8; k += 4) {
    for (int j = 0; j < 2; ++j) {
      b[k + j] = __builtin_shufflevector(a[k + j], a[k + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      b[k + j + 2] = __builtin_shufflevector(a[k + j], a[k + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (int j = 0; j < 4; ++j) {
    x[j] = __builtin_shufflevector(b[j], b[j + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    x[j + 4] = __builtin_shufflevector(b[j], b[j + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
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
  size_t before = 0;  // meetings that were collected and computed
};

void approach_ellipsoids(const ModelForm& m, Collected& in, const MeetingColumns& out,
                         const EllipsoidColumns& ellipsoids) {
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
  const F along = opacity(depth, exp_below_zero(-depth)), range = load(in.range);
  const I inside = (delta2 <= all(m.tau2)) & (a.t >= all(m.min_range_m)) & (a.t <= load(in.reach)) &
                   (a.t - kFarthestMisfit * a.sigma <= range);
  const F p = pick(inside, pick(per_m > all(0), along, load(in.p)), all(-1));
  for (size_t k = 0; k < in.count; ++k) {
    const uint32_t at = in.place[k];
    out.t_m[at] = a.t[k];
    out.sigma_m[at] = a.sigma[k];
    out.p[at] = p[k];
  }
  const size_t at = in.before;
  store(ellipsoids.t_m + at, a.t);
  store(ellipsoids.sigma_m + at, a.sigma);
  store(ellipsoids.depth + at, depth);
  store(ellipsoids.range_m + at, range);
  for (int k = 0; k < 3; ++k) {
    store(ellipsoids.n[k] + at, a.n[k]);
    store(ellipsoids.c[k] + at, a.c[k]);
  }
  in.before += in.count;
  in.count = 0;
}

inline void collect(const ListedBeam& b, const EllipsoidForm& e, float leaves, size_t place,
                    Collected& c) {
  const size_t k = c.count++;
  for (int i = 0; i < 3; ++i) {
    c.o[i][k] = b.origin[i];
    c.d[i][k] = b.direction[i];
    c.mean[i][k] = e.mean[i];
  }
  for (int i = 0; i < 6; ++i) c.whiten[i][k] = e.whiten[i];
  c.range[k] = b.range_m;
  c.reach[k] = b.reach_m;
  c.opacity[k] = e.opacity_per_m * leaves;
  c.p[k] = e.p;
  c.place[k] = uint32_t(place);
}

size_t approach(const ModelForm& m, const ListedBeam* beams, const uint32_t* first, size_t beam,
                size_t beam_end, const uint32_t* met, const TriangleMeeting* on_triangle,
                const MeetingColumns& out, const EllipsoidColumns& ellipsoids) {
  const size_t begin = first[beam], count = first[beam_end] - begin;
  Collected c{};
  for (size_t b = beam; b < beam_end; ++b) {
    const float z = beams[b].direction[2];
    const float leaves = __builtin_sqrtf(m.leaf_level + m.leaf_slope * z * z);
    for (size_t s = first[b]; s < first[b + 1]; ++s) {
      const size_t at = s - begin;
      out.density[at] = beams[b].range_m;
      if (met[s] >= m.triangles) {
        ellipsoids.place[c.before + c.count] = uint32_t(at);
        ellipsoids.beam[c.before + c.count] = uint32_t(b);
        collect(beams[b], m.ellipsoids[met[s] - m.triangles], leaves, at, c);
        if (c.count == kLanes) approach_ellipsoids(m, c, out, ellipsoids);
        continue;
      }
      const size_t mesh = met[s] >= m.ground_triangles;
      const auto [t, tilt] = *on_triangle++;
      out.t_m[at] = t;
      out.sigma_m[at] =
          __builtin_sqrtf(m.range_variance[mesh] + m.roughness_variance[met[s]] * tilt);
      const bool inside = t >= m.min_range_m && t <= beams[b].reach_m;
      out.p[at] = inside ? m.triangle_p[met[s]] : -1;
    }
  }
  if (c.count) approach_ellipsoids(m, c, out, ellipsoids);
  for (size_t k = 0; k < count; k += kLanes) {
    const F sigma = load(out.sigma_m + k), x = (load(out.density + k) - load(out.t_m + k)) / sigma;
    const I near = (x < all(kFarthestMisfit)) & (x > all(-kFarthestMisfit));
    const F y = pick(near, x, all(0));
    const F density = pick(near, exp_below_zero(-0.5f * y * y) / (sigma * kRootTwoPi), all(0));
    store(out.density + k, density);
  }
  return c.before;
}

// The terms of eight meetings in fixed point: added to `kShift`, a double has the term in its low
// bits.
struct Terms {
  L of[kSumRow];

  Terms() {
    for (size_t f = kSumFields; f < kSumRow; ++f) of[f] = L{};
  }

  void set(size_t field, F term) {
    constexpr double kShift = 0x1.8p26;  // 1.5 · 2⁵², times 2⁻²⁶
    term = greater(lesser(term, all(1e4f)), all(-1e4f));
    const D shifted = __builtin_convertvector(term, D) + kShift;
    of[field] = (L)shifted - __builtin_bit_cast(int64_t, kShift);
  }
};

// Holds the lock of a row.
class RowLock {
 public:
  explicit RowLock(uint8_t* lock) : lock_(lock) {
    while (__atomic_test_and_set(lock_, __ATOMIC_ACQUIRE)) {
    }
  }
  ~RowLock() { __atomic_clear(lock_, __ATOMIC_RELEASE); }
  RowLock(const RowLock&) = delete;
  RowLock& operator=(const RowLock&) = delete;

 private:
  uint8_t* lock_;
};

// The shares of eight meetings, zero in lanes that are not used.
struct Shares {
  F hit, pass;
};

// Adds the derivatives of the beams' log-likelihood by ln κ, s and E. The optical depth a = κ √(2π)
// σ e^{−δ²/2} changes by
//   ∂ ln a = k + c·s + nᵀEn + cᵀEc
// with the whitened direction n and the whitened point of closest approach c. The misfit x = (z −
// t)/σ changes by ∂x = −n·s − 2 nᵀEc − x nᵀEn, and σ by ∂ ln σ = nᵀEn. The log-likelihood of the
// beam is r [ln(1 − e^{−a}) − ln σ − x²/2] − (the share that went through) a.
inline void find_terms(const EllipsoidColumns& m, size_t at, const Shares& s, Terms& terms) {
  const F t = load(m.t_m + at), sigma = load(m.sigma_m + at);
  const F n[3] = {load(m.n[0] + at), load(m.n[1] + at), load(m.n[2] + at)};
  const F c[3] = {load(m.c[0] + at), load(m.c[1] + at), load(m.c[2] + at)};
  F depth = load(m.depth + at);
  depth = greater(depth, all(1e-20f));
  const F through = exp_below_zero(-depth);
  // `odds` is a / (eᵃ − 1); odds × a is the Fisher information in ln a of a trial with p = 1 − e⁻ᵃ.
  const F odds = depth * through / opacity(depth, through);
  const F slope = s.hit * odds - s.pass * depth, weight = (s.hit + s.pass) * odds * depth;
  const F x = pick(s.hit >= all(kNegligible), (load(m.range_m + at) - t) / sigma, all(0));
  terms.set(kHits, s.hit);
  terms.set(kPasses, s.pass);
  terms.set(kDensitySlope, slope);
  terms.set(kDensityCurvature, weight);
  for (size_t k = 0; k < 3; ++k) terms.set(kShiftSlope + k, slope * c[k] + s.hit * x * n[k]);
  constexpr int kRow[6] = {0, 0, 0, 1, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 2};
  for (size_t k = 0; k < 6; ++k) {
    const int i = kRow[k], j = kColumn[k];
    const F nn = n[i] * n[j], cc = c[i] * c[j], nc = n[i] * c[j] + c[i] * n[j], both = nn + cc;
    const F xx = x * x;
    terms.set(kShiftCurvature + k, weight * cc + s.hit * nn);
    terms.set(kStretchSlope + k, slope * both + s.hit * ((xx - 1.0f) * nn + x * nc));
    terms.set(kStretchCurvature + k, weight * both * both + s.hit * (nc * nc + 2.0f * nn * nn));
    terms.set(kAlong + k, s.hit * xx * nn);
  }
}

void add(const EllipsoidColumns& meetings, size_t count, const uint32_t* ellipsoid,
         uint32_t first_ellipsoid, const ShareColumns& shares, const SumTable& sums) {
  for (size_t at = 0; at < count; at += kLanes) {
    const size_t lanes = count - at < kLanes ? count - at : kLanes;
    float hit[kLanes] = {}, pass[kLanes] = {};
    bool counts[kLanes] = {};
    uint32_t row[kLanes] = {};
    for (size_t k = 0; k < lanes; ++k) {
      const uint32_t place = meetings.place[at + k];
      hit[k] = shares.hit[place];
      pass[k] = shares.pass[place];
      counts[k] = hit[k] >= kNegligible || pass[k] >= kNegligible;
      row[k] = ellipsoid[place] - first_ellipsoid;
      for (size_t f = 0; f < kSumRow; f += kLanes)
        __builtin_prefetch(sums.sums + row[k] * kSumRow + f, 1);
    }
    Terms terms;
    find_terms(meetings, at, {load(hit), load(pass)}, terms);
    for (size_t f = 0; f < kSumRow; f += kLanes) transpose(terms.of + f);
    for (size_t k = 0; k < lanes; ++k) {
      if (!counts[k]) continue;
      const RowLock lock(sums.locks + (row[k] & sums.lock_mask));
      int64_t* const to = sums.sums + row[k] * kSumRow;
      for (size_t f = 0; f < kSumRow / kLanes; ++f) {
        L old;
        __builtin_memcpy(&old, to + f * kLanes, sizeof old);
        old += terms.of[f * kLanes + k];
        __builtin_memcpy(to + f * kLanes, &old, sizeof old);
      }
    }
  }
}

}  // namespace
}  // namespace underbrush::likelihood
