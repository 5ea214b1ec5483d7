// Tests the rays of a packet against a block of pairs of triangles, as packet_ellipsoids.inl does
// for ellipsoids. kernel_*.cpp use this file.
#pragma once
#include "underbrush/trace/packet_finds.inl"

namespace underbrush::trace {
namespace {

inline F8 length(const F8 v[3]) {
  return root(muladd(v[0], v[0], muladd(v[1], v[1], v[2] * v[2])));
}

inline void test_children(const PacketQuery& s, const Frame& f, const TriangleBlock& block,
                          unsigned groups, ChildTests& tests) {
  const Rays& r = *f.rays;
  auto& out = tests.triangle;
  F8 v[3], side[3][3];
  for (int a = 0; a < 3; ++a) {
    const F8 corner = load8(block.corner[0][a]);
    v[a] = (corner - all8(f.high[a])) - all8(f.low[a]);
    store(out.corner[a], v[a]);
    for (int k = 0; k < 3; ++k) {
      side[k][a] = load8(block.corner[k + 1][a]) - corner;
      store(out.side[k][a], side[k][a]);
    }
  }
  const F8 l[3] = {length(side[0]), length(side[1]), length(side[2])};
  const F8 away = length(v) + all8(r.spread), longest = greater(l[0], greater(l[1], l[2]));
  F8 from[3], to[3];
  for (int p = 0; p < 3; ++p) {
    const float* n = r.axis[p];
    const auto along = [&](const F8 x[3]) {
      return muladd(x[0], all8(n[0]), muladd(x[1], all8(n[1]), x[2] * all8(n[2])));
    };
    const F8 at = along(v), a = along(side[0]), b = along(side[1]), c = along(side[2]);
    const F8 pad = muladd(longest, all8(2.0f), away) * 1e-6f;
    from[p] = at + lesser(lesser(F8{}, a), lesser(b, c)) - pad;
    to[p] = at + greater(greater(F8{}, a), greater(b, c)) + pad;
  }
  bound_slopes(r, from, to, tests.seen);
  find_meetings<false>(r, s.found.reach, tests.seen, groups, tests.meetings);
  const I8 alone = no_element(block.element[1]);
  for (int k = 0; k < 2; ++k) {
    const F8 *e1 = side[k], *e2 = side[k + 1], around = l[k] + l[k + 1], reach = away + around;
    const F8 slack = reach * around * 1e-6f, doubtful = -3.0f * slack;
    store(out.of[k].slack, slack);
    store(out.of[k].doubtful, k == 1 ? pick(alone, all8(INFINITY), doubtful) : doubtful);
    store(out.of[k].range_slack, reach * l[k] * l[k + 1] * 1e-6f);
    F8 height{};
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      const F8 normal = muladd(e2[b], e1[c], -(e2[c] * e1[b]));
      height = muladd(v[a], normal, height);
      store(out.of[k].normal[a], normal);
    }
    store(out.of[k].height, height);
  }
}

// Tests the packet against a block, and gives the sets of groups that found something.
// long: one kernel, whose two loops share the block's numbers and the arrays of a pair.
template <Query kQuery>
inline unsigned visit(PacketQuery& s, const Frame& f, const TriangleBlock& b,
                      const ChildTests& tests) {
  const Rays& r = *f.rays;
  const auto& corner = tests.triangle.corner;
  const auto& side = tests.triangle.side;
  struct alignas(128) {
    F signed_det, least_weight;
    unsigned pair, which, group;
  } met[2 * 8 * kGroups + 1], *to = met;
  unsigned sets = 0;
  const uint32_t first = kInBlock | uint32_t(&b - f.triangles) * (2 * kWidth);
  for_each(tests.meetings, [&](unsigned j, unsigned g) {
    // The moments of the rays about the corner are c = (o − corner) × d. The weights of the other
    // corners of a triangle are c·side2 and −c·side1.
    const F vx = all(corner[0][j]), vy = all(corner[1][j]), vz = all(corner[2][j]);
    const F dx = r.d[0][g], dy = r.d[1][g], dz = r.d[2][g];
    const F cx = muladd(vz, dy, minus_product(r.moment[0][g], vy, dz)),
            cy = muladd(vx, dz, minus_product(r.moment[1][g], vz, dx)),
            cz = muladd(vy, dx, minus_product(r.moment[2][g], vx, dy));
    F weight[3];
    for (int k = 0; k < 3; ++k) {
      weight[k] =
          muladd(all(side[k][0][j]), cx, muladd(all(side[k][1][j]), cy, all(side[k][2][j]) * cz));
    }
    for (int k = 0; k < 2; ++k) {
      const auto& of = tests.triangle.of[k];
      const F signed_det = muladd(all(of.normal[0][j]), dx,
                                  muladd(all(of.normal[1][j]), dy, all(of.normal[2][j]) * dz));
      const F det = absolute(signed_det), sign = sign_of(signed_det);
      const F x = flip(weight[k + 1], sign), minus_y = flip(weight[k], sign);
      const F least_weight = lesser(x, lesser(-minus_y, det - x + minus_y));
      *to = {signed_det, least_weight, j, unsigned(k), g};
      to += bits(le(all(of.doubtful[j]), least_weight)) != 0;
    }
  });
  const int count = int(to - met);
  for (int k = 0; k < count; ++k) {
    const unsigned which = met[k].which, j = met[k].pair, g = met[k].group;
    const auto& of = tests.triangle.of[which];
    const F signed_det = met[k].signed_det, det = absolute(signed_det);
    const F least_weight = met[k].least_weight, limit = all(of.doubtful[j]);
    const F i = 1.0f / greater(det, all(of.slack[j]));
    const F from_origin =
        muladd(all(of.normal[0][j]), r.o[0][g],
               muladd(all(of.normal[1][j]), r.o[1][g], all(of.normal[2][j]) * r.o[2][g]));
    const F t = flip(all(of.height[j]) - from_origin, sign_of(signed_det)) * i;
    const F error = muladd(all(of.range_slack[j]), i, absolute(t) * 6e-7f);
    const F low = t - error, high = t + error;
    const F most = kQuery == Query::kAll ? all(f.t_max) : s.found.high[g];
    M found =
        le(limit, least_weight) & (M(le(all(f.t_min), high) & le(low, most)) | le(det, -limit));
    M sure = found;
    const uint32_t element = b.element[which][j] & kElementMask;
    if (kQuery == Query::kAccepted) {
      const Trial trial =
          trial_at(s, f, f.grain, false, int(g), element, b.accept_below[which][j], t, error);
      sure &= trial.sure;
      found &= trial.maybe;
    }
    if (!bits(found)) continue;
    if (kQuery != Query::kAll) {
      sure &= le(all(of.slack[j]), least_weight) & le(high, s.found.low[g]) & le(all(f.t_min), low);
    }
    record<kQuery>(s, f, int(g), element, first | (2 * j + which), found, sure, low, high, F{});
    sets |= 1u << g / 8;
  }
  return sets;
}

}  // namespace
}  // namespace underbrush::trace
