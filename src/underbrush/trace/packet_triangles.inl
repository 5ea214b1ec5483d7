// Tests the rays of a packet against a block of triangles, as packet_ellipsoids.inl does for
// ellipsoids. kernel_*.cpp use this file.
#pragma once
#include "underbrush/trace/packet_finds.inl"

namespace underbrush::trace {
namespace {

inline void test_children(const PacketQuery& s, const Frame& f, const TriangleBlock& b,
                          unsigned groups, ChildTests& tests) {
  const Rays& r = *f.rays;
  F8 v[3], e1[3], e2[3];
  for (int a = 0; a < 3; ++a) {
    const F8 corner = load8(b.corner[0][a]);
    v[a] = (corner - f.high[a]) - f.low[a];
    e1[a] = load8(b.corner[1][a]) - corner;
    e2[a] = load8(b.corner[2][a]) - corner;
  }
  const F8 l1 = root(muladd(e1[0], e1[0], muladd(e1[1], e1[1], e1[2] * e1[2])));
  const F8 l2 = root(muladd(e2[0], e2[0], muladd(e2[1], e2[1], e2[2] * e2[2])));
  const F8 away = root(muladd(v[0], v[0], muladd(v[1], v[1], v[2] * v[2]))) + r.spread;
  F8 from[3], to[3];
  for (int p = 0; p < 3; ++p) {
    const float* n = r.axis[p];
    const F8 at = muladd(v[0], all8(n[0]), muladd(v[1], all8(n[1]), v[2] * n[2]));
    const F8 along1 = muladd(e1[0], all8(n[0]), muladd(e1[1], all8(n[1]), e1[2] * n[2]));
    const F8 along2 = muladd(e2[0], all8(n[0]), muladd(e2[1], all8(n[1]), e2[2] * n[2]));
    const F8 pad = (away + l1 + l2) * 1e-6f;
    from[p] = at + lesser(F8{}, lesser(along1, along2)) - pad;
    to[p] = at + greater(F8{}, greater(along1, along2)) + pad;
  }
  bound_slopes(r, from, to, tests.seen);
  tests.pairs = pairs_of<false>(r, s.found.reach, tests.seen, groups).any;
  store(tests.triangle.slack, (away + l1 + l2) * (l1 + l2) * 8e-7f);
  store(tests.triangle.range_slack, (away + l1 + l2) * l1 * l2 * 1e-6f);
  for (int a = 0; a < 3; ++a) {
    store(tests.triangle.corner[a], v[a]);
    store(tests.triangle.side1[a], e1[a]);
    store(tests.triangle.side2[a], e2[a]);
  }
}

// Tests the packet against a block, and gives the sets of groups that found something.
// long: one kernel, whose two loops share the block's numbers and the arrays of a pair.
template <Query kQuery>
inline unsigned visit(PacketQuery& s, const Frame& f, const TriangleBlock& b,
                      const ChildTests& tests) {
  const Rays& r = *f.rays;
  const auto& corner = tests.triangle.corner;
  const auto& side1 = tests.triangle.side1;
  const auto& side2 = tests.triangle.side2;
  const auto& slack = tests.triangle.slack;
  const auto& range_slack = tests.triangle.range_slack;
  M maybe[8 * kGroups];
  F met[8 * kGroups][3];
  uint8_t pair_of[8 * kGroups];
  int count = 0;
  unsigned sets = 0;
  filter(tests.pairs, [&](int j, int g) {
    const F e1x = all(side1[0][j]), e1y = all(side1[1][j]), e1z = all(side1[2][j]);
    const F e2x = all(side2[0][j]), e2y = all(side2[1][j]), e2z = all(side2[2][j]);
    const F dx = r.d[0][g], dy = r.d[1][g], dz = r.d[2][g];
    const F sx = r.o[0][g] - corner[0][j], sy = r.o[1][g] - corner[1][j],
            sz = r.o[2][g] - corner[2][j];
    const F px = muladd(dy, e2z, -(dz * e2y)), py = muladd(dz, e2x, -(dx * e2z)),
            pz = muladd(dx, e2y, -(dy * e2x));
    const F qx = muladd(sy, e1z, -(sz * e1y)), qy = muladd(sz, e1x, -(sx * e1z)),
            qz = muladd(sx, e1y, -(sy * e1x));
    const F signed_det = muladd(e1x, px, muladd(e1y, py, e1z * pz)), sign = sign_of(signed_det);
    const F det = absolute(signed_det);
    const F x = flip(muladd(sx, px, muladd(sy, py, sz * pz)), sign);
    const F y = flip(muladd(dx, qx, muladd(dy, qy, dz * qz)), sign);
    const F least_weight = lesser(x, lesser(y, det - x - y));
    maybe[count] = le(all(-3 * slack[j]), least_weight);
    const F t = flip(muladd(e2x, qx, muladd(e2y, qy, e2z * qz)), sign);
    met[count][0] = det;
    met[count][1] = t;
    met[count][2] = least_weight;
    pair_of[count] = uint8_t(kGroups * j + g);
    const bool met_any = bits(maybe[count]) != 0;
    count += met_any;
    return met_any;
  });
  for (int k = 0; k < count; ++k) {
    const int pair = pair_of[k], j = pair / kGroups, g = pair % kGroups;
    const F det = met[k][0], least_weight = met[k][2], doubtful = all(3 * slack[j]);
    const F i = 1.0f / greater(det, all(slack[j]));
    const F t = met[k][1] * i;
    const F error = muladd(all(range_slack[j]), i, absolute(t) * 6e-7f);
    const F low = t - error, high = t + error;
    const F limit = kQuery == Query::kAll ? all(f.t_max) : s.found.high[g];
    M found = maybe[k] & (M(le(all(f.t_min), high) & le(low, limit)) | le(det, doubtful));
    M sure = found;
    if (kQuery == Query::kAccepted) {
      const Trial trial = trial_at(s, f, f.grain[0], g, b.element[j], b.accept_below[j], t, error);
      sure &= trial.sure;
      found &= trial.maybe;
    }
    if (!bits(found)) continue;
    if (kQuery != Query::kAll) {
      sure &= le(all(slack[j]), least_weight) & le(high, s.found.low[g]) & le(all(f.t_min), low);
    }
    record<kQuery>(s, f, g, b.element[j], found, sure, low, high);
    sets |= 1u << g / 8;
  }
  return sets;
}

}  // namespace
}  // namespace underbrush::trace
