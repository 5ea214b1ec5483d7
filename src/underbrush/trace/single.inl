// Traces one ray through the tree, eight boxes or elements at a time, for rays that do not point
// alike. Every candidate is decided in double precision. kernel_*.cpp use this file.
#pragma once
#include <cstdint>

#include "underbrush/trace/bvh.hpp"
#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/simd.inl"

namespace underbrush::trace {
namespace {

struct RayF {
  float o[3], o_low[3], d[3];  // the origin as a sum of two floats
  float lower[3], upper[3];    // the origin, moved outwards so that boxes come out too large
  float inverse[3];
  int near[3];  // 0 if lo is nearer along this axis, 1 if hi is
  uint32_t key_low, key_high;

  RayF(const double origin[3], const double direction[3], uint64_t key) {
    for (int k = 0; k < 3; ++k) {
      o[k] = float(origin[k]);
      o_low[k] = float(origin[k] - double(o[k]));
      d[k] = float(direction[k]);
      const float pad = __builtin_fabsf(o[k]) * 2.5e-7f;
      lower[k] = o[k] + pad;
      upper[k] = o[k] - pad;
      inverse[k] = 1 / (d[k] == 0 ? 1e-20f : d[k]);
      near[k] = inverse[k] < 0;
    }
    key_low = uint32_t(key);
    key_high = uint32_t(key >> 32);
  }
};

// Finds the lanes whose closest approach may be within τ and in [t_min, limit]. A margin covers the
// rounding of single precision, so some lanes are too many and none is missing.
inline unsigned ellipsoid_candidates(const RayF& r, const EllipsoidBlock& b, float t_min,
                                     float limit) {
  F8 q[3], t0{};
  for (int k = 0; k < 3; ++k) {
    q[k] = (load8(b.mean[k]) - all8(r.o[k])) - all8(r.o_low[k]);
    t0 += q[k] * r.d[k];
  }
  for (int k = 0; k < 3; ++k) q[k] -= t0 * r.d[k];
  const F8 u00 = load8(b.u[0]), u01 = load8(b.u[1]), u02 = load8(b.u[2]);
  const F8 u11 = load8(b.u[3]), u12 = load8(b.u[4]), u22 = load8(b.u[5]);
  const F8 a0 = u00 * r.d[0] + u01 * r.d[1] + u02 * r.d[2];
  const F8 a1 = u11 * r.d[1] + u12 * r.d[2];
  const F8 a2 = u22 * r.d[2];
  const F8 b0 = u00 * q[0] + u01 * q[1] + u02 * q[2];
  const F8 b1 = u11 * q[1] + u12 * q[2];
  const F8 b2 = u22 * q[2];
  const F8 a = a0 * a0 + a1 * a1 + a2 * a2;
  const F8 h = a0 * b0 + a1 * b1 + a2 * b2;
  const F8 c = b0 * b0 + b1 * b1 + b2 * b2;
  const F8 size =
      absolute(u00) + absolute(u01) + absolute(u02) + absolute(u11) + absolute(u12) + absolute(u22);
  // |δ(Uq)| ≲ ε |t0| Σ|U|, and the bound on |Uq|² grows by twice that where |Uq| is near 1.
  const F8 slack = (absolute(t0) + 1.0f) * size * 1e-6f + 4e-4f;
  const F8 bound = (1.0f + slack) * (1.0f + slack);
  const F8 step = h / a, t = t0 + step, reach = root(1.0f / a);
  const F8 t_slack = (absolute(t0) + absolute(step)) * 1e-6f +
                     reach * (slack + size * 1e-6f * (absolute(step) + reach));
  const I8 inside = le((c - bound) * a, h * h * 1.00001f) & le(t - t_slack, all8(limit)) &
                    le(all8(t_min), t + t_slack);
  return bits(inside);
}

// Finds the lanes whose first or second triangle the ray may cross before `limit`, with a margin.
inline unsigned triangle_candidates(const RayF& r, const TriangleBlock& b, int which, float limit) {
  F8 p[3][3];
  for (int v = 0; v < 3; ++v) {
    const auto& corner = b.corner[v == 0 ? 0 : v + which];
    for (int k = 0; k < 3; ++k) p[v][k] = (load8(corner[k]) - all8(r.o[k])) - all8(r.o_low[k]);
  }
  const F8 t0 = p[0][0] * r.d[0] + p[0][1] * r.d[1] + p[0][2] * r.d[2];
  F8 size{};
  for (int v = 0; v < 3; ++v) {
    for (int k = 0; k < 3; ++k) {
      p[v][k] -= t0 * r.d[k];
      size += absolute(p[v][k]);
    }
  }
  F8 edge[3];
  for (int e = 0; e < 3; ++e) {
    const F8* x = p[(e + 1) % 3];
    const F8* y = p[(e + 2) % 3];
    edge[e] = (x[1] * y[2] - x[2] * y[1]) * r.d[0] + (x[2] * y[0] - x[0] * y[2]) * r.d[1] +
              (x[0] * y[1] - x[1] * y[0]) * r.d[2];
  }
  const F8 slack = (size + absolute(t0) * 1e-6f) * (size * 2e-6f + absolute(t0) * 1e-6f);
  const F8 smallest = lesser(edge[0], lesser(edge[1], edge[2]));
  const F8 largest = greater(edge[0], greater(edge[1], edge[2]));
  const I8 is_there = ~no_element(b.element[which]);
  return bits((le(-slack, smallest) | le(largest, slack)) & le(t0 - size, all8(limit + 1e-3f)) &
              is_there);
}

// Tests eight boxes by slabs. Gives the lanes that are entered in [t_min, limit], and where.
inline unsigned enter(const RayF& r, const Node& n, float t_min, float limit, F8& entry) {
  F8 near = all8(t_min), far = all8(limit);
  for (int k = 0; k < 3; ++k) {
    const F8 lo = load8(n.lo[k]) - r.lower[k], hi = load8(n.hi[k]) - r.upper[k];
    near = greater(near, (r.near[k] ? hi : lo) * r.inverse[k]);
    far = lesser(far, (r.near[k] ? lo : hi) * r.inverse[k]);
  }
  entry = near * 0.999998f;
  return bits(le(entry, far * 1.000002f));
}

// Visits the leaves that the ray enters before limit(), the nearer ones first.
template <class Limit, class Leaf>
inline void visit(const Node* nodes, uint32_t root, const RayF& ray, float t_min, Limit limit,
                  Leaf leaf) {
  struct StackEntry {
    uint32_t reference;
    float t;
  };
  StackEntry stack[256];
  int top = 0;
  stack[top++] = {root, 0};
  while (top > 0) {
    const StackEntry at = stack[--top];
    if (at.t > limit()) continue;
    if (at.reference & kLeaf) {
      leaf(at.reference);
      continue;
    }
    const Node& node = nodes[at.reference];
    F8 entry;
    unsigned hit = enter(ray, node, t_min, limit(), entry);
    const int base = top;
    while (hit) {
      const int k = __builtin_ctz(hit);
      hit &= hit - 1;
      const float t = entry[k];
      int put = top++;
      while (put > base && stack[put - 1].t < t) {
        stack[put] = stack[put - 1];
        --put;
      }
      stack[put] = {node.child[k], t};
    }
  }
}

inline unsigned accepted(const uint32_t* accept_below, const uint32_t* element, uint32_t mask,
                         const RayF& ray) {
  const U8 b = *reinterpret_cast<const U8*>(accept_below);
  const U8 zero{};
  const U8 h = accept_hash<U8>(*reinterpret_cast<const U8*>(element) & mask, zero + ray.key_low,
                               zero + ray.key_high);
  return bits(below(h, b) | equal(b, zero + kAlways));
}

// long: the ray and its limit are shared by the three kinds of leaves.
inline void trace_one(const View& view, Query query, Batch& batch, size_t i) {
  const Ray& r = batch.rays[i];
  if (query != Query::kAll) batch.best[i] = Intersection{};
  const float t_min = float(batch.limits.min_m) * 0.999999f;
  const float t_max = float(batch.limits.max_m) * 1.000001f;
  float limit = query == Query::kAll ? float(batch.entry_limits_m[i]) * 1.000001f : t_max;
  double origin[3];
  for (int a = 0; a < 3; ++a) origin[a] = r.origin.data()[a] - view.origin[a];
  const RayF world(origin, r.direction.data(), 0);
  const auto in_instance = [&](uint32_t reference) {
    const Subtree entry = view.entries[reference & kIndexMask];
    const Placement p = place(view, entry.instance, origin);
    const Bvh& bvh = *p.bvh;
    double d[3];
    for (int a = 0; a < 3; ++a) {
      const double* row = p.rotation + 3 * a;
      d[a] = row[0] * r.direction.data()[0] + row[1] * r.direction.data()[1] +
             row[2] * r.direction.data()[2];
    }
    const RayF ray(p.centre, d, (query == Query::kAccepted ? batch.keys[i] : 0) ^ p.salt);
    const bool anew = query == Query::kAccepted && p.cells_per_m->triangles == 0;
    const float shrink = float(1 / p.scale);
    const float least = t_min * shrink * 0.999999f, most = t_max * shrink * 1.000001f;
    const auto reach = [&] { return limit * shrink * 1.000001f; };
    const auto resolve = [&](unsigned lanes, const uint32_t* elements, uint32_t mask) {
      while (lanes) {
        const int k = __builtin_ctz(lanes);
        const uint32_t element = elements[k] & mask;
        lanes &= lanes - 1;
        if (query == Query::kAll) {
          add_candidate(batch, {uint32_t(i), entry.instance, element}, {-__builtin_inff(), 0});
        } else if (resolve_nearest(view, query, batch, i, entry.instance, element, 0,
                                   Intersection::kNone)) {
          limit = float(batch.best[i].t_m) * 1.000001f;
        }
      }
    };
    visit(bvh.nodes.data(), entry.node, ray, least, reach, [&](uint32_t leaf) {
      const uint32_t index = leaf & kIndexMask;
      const LeafKind kind = leaf_kind(leaf);
      const float end = query == Query::kAll ? most : reach();
      if (kind == LeafKind::kTriangles) {
        const TriangleBlock& b = bvh.triangles[index];
        for (int which = 0; which < 2; ++which) {
          unsigned lanes = triangle_candidates(ray, b, which, end);
          if (lanes && anew) {
            lanes &= accepted(b.accept_below[which], b.element[which], kElementMask, ray);
          }
          resolve(lanes, b.element[which], kElementMask);
        }
      } else if (query != Query::kSurface) {
        const EllipsoidBlock& b = bvh.ellipsoids[index];
        unsigned lanes = ellipsoid_candidates(ray, b, least, end);
        if (lanes && anew && kind != LeafKind::kPathLength) {
          lanes &= accepted(b.accept_below, b.element, kElementMask, ray);
        }
        resolve(lanes, b.element, kElementMask);
      }
    });
  };
  visit(
      view.nodes, view.root, world, t_min, [&] { return limit; }, in_instance);
}

}  // namespace
}  // namespace underbrush::trace
