// Tests the rays of a packet against a block of ellipsoids. A frustum test of eight ellipsoids
// comes first; what is left is tested against the rays, kLanes at a time. kernel_*.cpp use this
// file.
#pragma once
#include "underbrush/trace/packet_finds.inl"

namespace underbrush::trace {
namespace {

// The random trials at an ellipsoid of path-length opacity. `m2` is δ²/τ² and `m2_error` a bound on
// its error; `reach` is τσ and `reach_error` a bound on its relative error.
inline Trial path_length_trial(const PacketQuery& s, const Frame& f, int g, uint32_t element,
                               Cells cells, float depth, F reach, F reach_error, F m2, F m2_error) {
  if (f.sways) sway(s, g, element, cells);
  const F one = all(1.0f), slack = all(1e-6f);
  F x = all(depth) * reach * exp_below_zero(-all(f.half_tau2) * greater(m2, all(0.0f)));
  F error = muladd(all(f.half_tau2), m2_error, reach_error) + 1e-5f;
  if (f.leaf_slope != 0) {
    const F z = f.rays->d[2][g];
    x *= root(greater(muladd(all(f.leaf_slope) * z, z, all(f.leaf_level)), all(0.0f)));
    error += 3e-4f;  // from the rounding of z, the most where the factor is least
  }
  const F low = one - exp_below_zero(-x * greater(one - error, all(0.0f)));
  const F high =
      pick(le(error, one), one - exp_below_zero(-x * muladd(all(2.0f), error, one)), one);
  const F trial =
      __builtin_convertvector((I)(trial_bits(s, f, g, element, cells) >> 8), F) * 0x1p-24f;
  return {M(le(trial, high + slack) | ~cells.sure), M(le(trial + 2.0f * slack, low) & cells.sure)};
}

inline void test_children(const PacketQuery& s, const Frame& f, const EllipsoidBlock& b,
                          unsigned groups, ChildTests& tests) {
  const Rays& r = *f.rays;
  F8 m[3];
  for (int a = 0; a < 3; ++a) m[a] = (load8(b.mean[a]) - all8(f.high[a])) - all8(f.low[a]);
  const F8 u00 = load8(b.u[0]), u01 = load8(b.u[1]), u02 = load8(b.u[2]);
  const F8 u11 = load8(b.u[3]), u12 = load8(b.u[4]), u22 = load8(b.u[5]);
  // The extent of the ellipsoid along a direction n is |U⁻ᵀ n|.
  const F8 r0 = 1.0f / u00, r1 = 1.0f / u11, r2 = 1.0f / u22;
  const F8 away = root(muladd(m[0], m[0], muladd(m[1], m[1], m[2] * m[2]))) + all8(r.spread);
  F8 from[3], to[3];
  for (int p = 0; p < 3; ++p) {
    const float* n = r.axis[p];
    const F8 n0 = all8(n[0]), n1 = all8(n[1]), n2 = all8(n[2]);
    const F8 w0 = n0 * r0, w1 = (n1 - u01 * w0) * r1, w2 = (n2 - u02 * w0 - u12 * w1) * r2;
    const F8 support = root(muladd(w0, w0, muladd(w1, w1, w2 * w2)));
    const F8 at = muladd(m[0], n0, muladd(m[1], n1, m[2] * n2));
    const F8 half = muladd(support, all8(1.005f), away * 1e-6f);
    from[p] = at - half;
    to[p] = at + half;
  }
  bound_slopes(r, from, to, tests.seen);
  find_meetings<false>(r, s.found.reach, tests.seen, groups, tests.meetings);
  // Bounds on the rounding: of the Mahalanobis distance (`slack`), and of the same for each metre
  // of range (`size`).
  const F8 size =
      absolute(u00) + absolute(u01) + absolute(u02) + absolute(u11) + absolute(u12) + absolute(u22);
  const F8 slack = muladd(away, size * 6e-7f, all8(4e-4f));
  const F8 outer = 1.0f + slack, inner = greater(1.0f - slack, F8{});
  store(tests.ellipsoid.slack, slack);
  store(tests.ellipsoid.outer2, outer * outer);
  store(tests.ellipsoid.inner2, inner * inner);
  store(tests.ellipsoid.size, size * 1e-6f);
  for (int a = 0; a < 3; ++a) store(tests.ellipsoid.mean[a], m[a]);
}

// Tests the packet against a block, and gives the sets of groups that found something.
// long: one kernel, whose two loops share the block's numbers and the arrays of a pair.
template <Query kQuery>
inline unsigned visit(PacketQuery& s, const Frame& f, const EllipsoidBlock& b, LeafKind kind,
                      const ChildTests& tests) {
  const Rays& r = *f.rays;
  const auto& mean = tests.ellipsoid.mean;
  const auto& slack = tests.ellipsoid.slack;
  const auto& size_of = tests.ellipsoid.size;
  struct alignas(256) {
    F a, h, c, t0;
    M maybe;
    unsigned element, group;
  } met[8 * kGroups + 1], *to = met;
  unsigned sets = 0;
  for_each(tests.meetings, [&](unsigned j, unsigned g) {
    const F dx = r.d[0][g], dy = r.d[1][g], dz = r.d[2][g];
    const F vx = all(mean[0][j]) - r.o[0][g], vy = all(mean[1][j]) - r.o[1][g],
            vz = all(mean[2][j]) - r.o[2][g];
    const F t0 = muladd(vx, dx, muladd(vy, dy, vz * dz));
    const F qx = muladd(-t0, dx, vx), qy = muladd(-t0, dy, vy), qz = muladd(-t0, dz, vz);
    const F u_0 = all(b.u[0][j]), u_1 = all(b.u[1][j]), u_2 = all(b.u[2][j]);
    const F u_3 = all(b.u[3][j]), u_4 = all(b.u[4][j]), u_5 = all(b.u[5][j]);
    const F a0 = muladd(u_0, dx, muladd(u_1, dy, u_2 * dz)), a1 = muladd(u_3, dy, u_4 * dz),
            a2 = u_5 * dz;
    const F b0 = muladd(u_0, qx, muladd(u_1, qy, u_2 * qz)), b1 = muladd(u_3, qy, u_4 * qz),
            b2 = u_5 * qz;
    const F a = muladd(a0, a0, muladd(a1, a1, a2 * a2));
    const F h = muladd(a0, b0, muladd(a1, b1, a2 * b2));
    const F c = muladd(b0, b0, muladd(b1, b1, b2 * b2));
    const F hh = h * h;
    const M maybe = le((c - all(tests.ellipsoid.outer2[j])) * a, hh * 1.00001f);
    *to = {a, h, c, t0, maybe, j, g};
    to += bits(maybe) != 0;
  });
  const int count = int(to - met);
  for (int k = 0; k < count; ++k) {
    const unsigned j = met[k].element, g = met[k].group;
    const F a = met[k].a, h = met[k].h, c = met[k].c, t0 = met[k].t0, hh = h * h;
    const F i = 1.0f / a, step = h * i, t = t0 + step, reach = root(i);
    const F error = reach * muladd(all(size_of[j]), absolute(step) + reach, all(slack[j])) +
                    (absolute(t0) + absolute(step)) * 6e-7f;
    const F low = t - error, high = t + error;
    M found = met[k].maybe & le(all(f.t_min), high) &
              le(low, kQuery == Query::kAll ? all(f.t_max) : s.found.high[g]);
    if (!bits(found)) continue;
    M sure = found;
    const uint32_t element = b.element[j] & kElementMask;
    const Lattice& grain = f.grains[b.element[j] >> kGrainShift];
    if (kQuery == Query::kAccepted && kind == LeafKind::kPathLength) {
      const F m2 = c - hh * i,
              m2_error = muladd(hh * i, all(1e-5f), all(slack[j] * (2 + slack[j])));
      const Trial trial =
          path_length_trial(s, f, int(g), element, cells_of(f, grain, int(g), t, error), b.depth[j],
                            reach, all(size_of[j]) * reach, m2, m2_error);
      found &= trial.maybe;
      sure &= trial.sure;
    } else if (kQuery == Query::kAccepted) {
      const Trial trial =
          trial_at(s, f, grain, f.sways, int(g), element, b.accept_below[j], t, error);
      sure &= kind == LeafKind::kCareful ? mask_of(0) : trial.sure;
      found &= trial.maybe;
    }
    if (!bits(found)) continue;
    if (kQuery == Query::kAccepted) {
      sure &= le((c - all(tests.ellipsoid.inner2[j])) * a, hh * 0.99999f) &
              le(high, s.found.low[g]) & le(all(f.t_min), low);
    }
    record<kQuery>(s, f, int(g), element, element, found, sure, low, high, reach);
    sets |= 1u << g / 8;
  }
  return sets;
}

}  // namespace
}  // namespace underbrush::trace
