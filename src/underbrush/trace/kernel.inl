// Included by kernel_*.cpp, one for each instruction set; UB_KERNELS names the table it defines. No
// inline function of a shared header may be called here: the linker could keep the copy that was
// compiled for a larger instruction set than the machine has.
#include <immintrin.h>

#include <cmath>

#include "underbrush/trace/kernel.hpp"

namespace underbrush::trace {
namespace {

typedef float F8 __attribute__((vector_size(32)));
typedef int32_t I8 __attribute__((vector_size(32)));
typedef uint32_t U8 __attribute__((vector_size(32)));

inline F8 load(const float* p) { return *reinterpret_cast<const F8*>(p); }
inline F8 all(float x) { return F8{x, x, x, x, x, x, x, x}; }
inline F8 lesser(F8 a, F8 b) { return a < b ? a : b; }
inline F8 greater(F8 a, F8 b) { return a > b ? a : b; }
inline F8 absolute(F8 a) { return (F8)((I8)a & 0x7fffffff); }
inline unsigned bits(I8 mask) {
#ifdef __AVX__
  return unsigned(_mm256_movemask_ps((__m256)mask));
#else
  const __m128 low = _mm_loadu_ps(reinterpret_cast<const float*>(&mask));
  const __m128 high = _mm_loadu_ps(reinterpret_cast<const float*>(&mask) + 4);
  return unsigned(_mm_movemask_ps(low) | _mm_movemask_ps(high) << 4);
#endif
}

// The hash of core/rng.hpp's accept_bits on eight elements at once.
inline U8 accept_hash(U8 element, uint32_t key_low, uint32_t key_high) {
  U8 x = element ^ key_low;
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = ((x ^ (x >> 15)) + key_high) * 0x846ca68bu;
  x = (x ^ (x >> 16)) * 0x9e3779b1u;
  return x ^ (x >> 15);
}

struct RayF {
  float o[3], o_low[3], d[3];  // the origin as a sum of two floats
  float box_o[3], reciprocal[3];
  float t_min, t_max;
  int near[3];  // 0: lo is nearer along this axis, 1: hi
  uint32_t key_low, key_high;

  explicit RayF(const Query& q) {
    for (int k = 0; k < 3; ++k) {
      const double od = q.origin.data()[k], dd = q.direction.data()[k];
      o[k] = float(od);
      o_low[k] = float(od - double(o[k]));
      d[k] = float(dd);
      const float safe = d[k] == 0 ? 1e-20f : d[k];
      reciprocal[k] = 1 / safe;
      box_o[k] = o[k];
      near[k] = reciprocal[k] < 0;
    }
    t_min = float(q.limits.min_m);
    t_max = float(q.limits.max_m);
    key_low = uint32_t(q.key);
    key_high = uint32_t(q.key >> 32);
  }
};

// Lanes whose Mahalanobis approach may be within τ and in (t_min, limit): a superset by a margin
// that covers the rounding of single precision.
inline unsigned ellipsoid_candidates(const RayF& r, const EllipsoidBlock& b, float limit) {
  F8 m[3], q[3];
  F8 t0 = all(0);
  for (int k = 0; k < 3; ++k) {
    m[k] = (load(b.mean[k]) - r.o[k]) - r.o_low[k];
    t0 += m[k] * r.d[k];
  }
  for (int k = 0; k < 3; ++k) q[k] = m[k] - t0 * r.d[k];
  const F8 u00 = load(b.u[0]), u01 = load(b.u[1]), u02 = load(b.u[2]);
  const F8 u11 = load(b.u[3]), u12 = load(b.u[4]), u22 = load(b.u[5]);
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
  // |δ(Uq)| ≲ ε |t0| Σ|U|; the bound on |Uq|² grows by twice that where |Uq| is near 1.
  const F8 slack = (absolute(t0) + 1.0f) * size * 1e-6f + 1e-4f;
  const F8 bound = (1.0f + slack) * (1.0f + slack);
  const F8 t = t0 + h / a;
  const F8 t_slack = absolute(t0) * 1e-6f + 1e-4f + slack / size * 4.0f;
  const I8 inside =
      ((c - bound) * a <= h * h * 1.00001f) & (t - t_slack <= limit) & (t + t_slack >= r.t_min);
  return bits(inside);
}

// Lanes whose triangle the ray may cross before `limit`, by a margin.
inline unsigned triangle_candidates(const RayF& r, const TriangleBlock& b, float limit) {
  F8 p[3][3];
  for (int v = 0; v < 3; ++v) {
    for (int k = 0; k < 3; ++k) p[v][k] = (load(b.corner[v][k]) - r.o[k]) - r.o_low[k];
  }
  const F8 t0 = p[0][0] * r.d[0] + p[0][1] * r.d[1] + p[0][2] * r.d[2];
  F8 size = all(0);
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
  const F8 least = lesser(edge[0], lesser(edge[1], edge[2]));
  const F8 most = greater(edge[0], greater(edge[1], edge[2]));
  return bits(((least >= -slack) | (most <= slack)) & (t0 - size <= limit + 1e-3f));
}

// Slab test of eight boxes: lanes entered before `limit`, and where.
inline unsigned enter(const RayF& r, const Node& n, float limit, F8& entry) {
  F8 near = all(r.t_min), far = all(limit);
  for (int k = 0; k < 3; ++k) {
    const float* lo = r.near[k] ? n.hi[k] : n.lo[k];
    const float* hi = r.near[k] ? n.lo[k] : n.hi[k];
    near = greater(near, (load(lo) - r.box_o[k]) * r.reciprocal[k]);
    far = lesser(far, (load(hi) - r.box_o[k]) * r.reciprocal[k]);
  }
  entry = near * 0.999998f;
  return bits(entry <= far * 1.000002f);
}

// Visits the leaves that the ray enters before limit(); nearer ones first if kOrdered.
template <bool kOrdered, class Limit, class Leaf>
inline void traverse(const View& view, const RayF& ray, Limit limit, Leaf leaf) {
  struct Entry {
    uint32_t node;
    float t;
  };
  Entry stack[256];
  int top = 0;
  if (view.root == (kLeaf | kIndexMask)) return;
  stack[top++] = {view.root, 0};
  while (top > 0) {
    const Entry at = stack[--top];
    if (at.t > limit()) continue;
    if (at.node & kLeaf) {
      leaf(at.node);
      continue;
    }
    const Node& node = view.nodes[at.node];
    F8 entry;
    unsigned hit = enter(ray, node, limit(), entry);
    const int base = top;
    while (hit) {
      const int k = __builtin_ctz(hit);
      hit &= hit - 1;
      const float t = entry[k];
      int at_k = top++;
      while (kOrdered && at_k > base && stack[at_k - 1].t < t) {
        stack[at_k] = stack[at_k - 1];
        --at_k;
      }
      stack[at_k] = {node.child[k], t};
    }
  }
}

inline unsigned accepted(const uint32_t* below, const uint32_t* element, const RayF& ray) {
  const U8 b = *reinterpret_cast<const U8*>(below);
  const U8 h = accept_hash(*reinterpret_cast<const U8*>(element), ray.key_low, ray.key_high);
  return bits((I8)(h < b) | (I8)(b == 0xffffffffu));
}

inline void nearest(const View& view, const Query& query, Met& best, bool only_triangles) {
  RayF ray(query);
  float limit = ray.t_max * 1.000001f;
  const auto settle = [&](unsigned lanes, const uint32_t* element) {
    while (lanes) {
      const int k = __builtin_ctz(lanes);
      lanes &= lanes - 1;
      if (settle_nearest(view, query, element[k], best)) limit = float(best.t_m) * 1.000001f;
    }
  };
  traverse<true>(
      view, ray, [&] { return limit; },
      [&](uint32_t leaf) {
        if (leaf & kTriangles) {
          const TriangleBlock& b = view.triangles[leaf & kIndexMask];
          unsigned lanes = triangle_candidates(ray, b, limit);
          if (lanes && !only_triangles) lanes &= accepted(b.accept_below, b.element, ray);
          settle(lanes, b.element);
        } else if (!only_triangles) {
          const EllipsoidBlock& b = view.ellipsoids[leaf & kIndexMask];
          unsigned lanes = ellipsoid_candidates(ray, b, limit);
          if (lanes) lanes &= accepted(b.accept_below, b.element, ray);
          settle(lanes, b.element);
        }
      });
}

void nearest_accepted(const View& view, const Query& query, Met& best) {
  nearest(view, query, best, false);
}

void nearest_triangle(const View& view, const Query& query, Met& best) {
  nearest(view, query, best, true);
}

void all_met(const View& view, const Query& query, double entry_limit_m, std::vector<Met>& met) {
  RayF ray(query);
  const float end = ray.t_max * 1.000001f;
  const float entry_limit = float(entry_limit_m) * 1.000001f;
  traverse<false>(
      view, ray, [&] { return entry_limit; },
      [&](uint32_t leaf) {
        const bool triangles = leaf & kTriangles;
        const uint32_t index = leaf & kIndexMask;
        const uint32_t* element =
            triangles ? view.triangles[index].element : view.ellipsoids[index].element;
        unsigned lanes = triangles ? triangle_candidates(ray, view.triangles[index], end)
                                   : ellipsoid_candidates(ray, view.ellipsoids[index], end);
        while (lanes) {
          const int k = __builtin_ctz(lanes);
          lanes &= lanes - 1;
          settle_all(view, query, element[k], met);
        }
      });
}

}  // namespace

extern const Kernels UB_KERNELS;
const Kernels UB_KERNELS = {UB_KERNELS_NAME, nearest_accepted, nearest_triangle, all_met};

}  // namespace underbrush::trace
