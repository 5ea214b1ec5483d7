// Tests the rays of a packet against a block of triangles, as packet_ellipsoids.inl does for
// ellipsoids. kernel_*.cpp use this file.
#pragma once
#include "underbrush/trace/packet_finds.inl"

namespace underbrush::trace {
namespace {

inline void test_children(const PacketQuery& s, const Frame& f, const TriangleBlock& block,
                          unsigned groups, ChildTests& tests) {
  const Rays& r = *f.rays;
  F8 v[3], e1[3], e2[3];
  for (int a = 0; a < 3; ++a) {
    const F8 corner = load8(block.corner[0][a]);
    v[a] = (corner - f.high[a]) - f.low[a];
    e1[a] = load8(block.corner[1][a]) - corner;
    e2[a] = load8(block.corner[2][a]) - corner;
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
  const F8 slack = (away + l1 + l2) * (l1 + l2) * 1e-6f;
  store(tests.triangle.slack, slack);
  store(tests.triangle.doubtful, -3.0f * slack);
  store(tests.triangle.range_slack, (away + l1 + l2) * l1 * l2 * 1e-6f);
  F8 height{};
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const F8 normal = muladd(e2[b], e1[c], -(e2[c] * e1[b]));
    height = muladd(v[a], normal, height);
    store(tests.triangle.corner[a], v[a]);
    store(tests.triangle.side1[a], e1[a]);
    store(tests.triangle.side2[a], e2[a]);
    store(tests.triangle.normal[a], normal);
  }
  store(tests.triangle.height, height);
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
  const auto& normal = tests.triangle.normal;
  const auto& height = tests.triangle.height;
  const auto& doubtful = tests.triangle.doubtful;
  const auto& slack = tests.triangle.slack;
  const auto& range_slack = tests.triangle.range_slack;
  struct {
    F signed_det, least_weight;
  } met[8 * kGroups + 1], *to = met;
  uint8_t pair_of[8 * kGroups + 1];
  static_assert(8 * kGroups <= 256);
  unsigned sets = 0;
  const uint32_t first = kInBlock | uint32_t(&b - f.triangles) * kWidth;
  for_each(tests.pairs, [&](unsigned j, unsigned g, unsigned pair) {
    // The moments of the rays about the corner are c = (o − corner) × d. The weights of the other
    // corners are c·side2 and −c·side1.
    const F e1x = all(side1[0][j]), e1y = all(side1[1][j]), e1z = all(side1[2][j]);
    const F e2x = all(side2[0][j]), e2y = all(side2[1][j]), e2z = all(side2[2][j]);
    const F nx = all(normal[0][j]), ny = all(normal[1][j]), nz = all(normal[2][j]);
    const F vx = all(corner[0][j]), vy = all(corner[1][j]), vz = all(corner[2][j]);
    const F dx = r.d[0][g], dy = r.d[1][g], dz = r.d[2][g];
    const F cx = muladd(vz, dy, minus_product(r.moment[0][g], vy, dz)),
            cy = muladd(vx, dz, minus_product(r.moment[1][g], vz, dx)),
            cz = muladd(vy, dx, minus_product(r.moment[2][g], vx, dy));
    const F signed_det = muladd(nx, dx, muladd(ny, dy, nz * dz)), sign = sign_of(signed_det);
    const F det = absolute(signed_det);
    const F x = flip(muladd(e2x, cx, muladd(e2y, cy, e2z * cz)), sign);
    const F minus_y = flip(muladd(e1x, cx, muladd(e1y, cy, e1z * cz)), sign);
    const F least_weight = lesser(x, lesser(-minus_y, det - x + minus_y));
    *to = {signed_det, least_weight};
    pair_of[to - met] = uint8_t(pair);
    to += bits(le(all(doubtful[j]), least_weight)) != 0;
  });
  const int count = int(to - met);
  for (int k = 0; k < count; ++k) {
    const unsigned j = child_of(pair_of[k]), g = group_of(pair_of[k]);
    const F signed_det = met[k].signed_det, det = absolute(signed_det);
    const F least_weight = met[k].least_weight, limit = all(doubtful[j]);
    const F i = 1.0f / greater(det, all(slack[j]));
    const F from_origin =
        muladd(all(normal[0][j]), r.o[0][g],
               muladd(all(normal[1][j]), r.o[1][g], all(normal[2][j]) * r.o[2][g]));
    const F t = flip(all(height[j]) - from_origin, sign_of(signed_det)) * i;
    const F error = muladd(all(range_slack[j]), i, absolute(t) * 6e-7f);
    const F low = t - error, high = t + error;
    const F most = kQuery == Query::kAll ? all(f.t_max) : s.found.high[g];
    M found =
        le(limit, least_weight) & (M(le(all(f.t_min), high) & le(low, most)) | le(det, -limit));
    M sure = found;
    if (kQuery == Query::kAccepted) {
      const Trial trial =
          trial_at(s, f, f.grain, false, int(g), b.element[j], b.accept_below[j], t, error);
      sure &= trial.sure;
      found &= trial.maybe;
    }
    if (!bits(found)) continue;
    if (kQuery != Query::kAll) {
      sure &= le(all(slack[j]), least_weight) & le(high, s.found.low[g]) & le(all(f.t_min), low);
    }
    record<kQuery>(s, f, int(g), b.element[j], first | j, found, sure, low, high);
    sets |= 1u << g / 8;
  }
  return sets;
}

}  // namespace
}  // namespace underbrush::trace
