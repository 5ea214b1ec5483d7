// `intersect` for many rays and elements, four elements of one kind at a time. kernel_*.cpp use
// this file.
#pragma once
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "underbrush/trace/exact.inl"
#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/many_kinds.inl"
#include "underbrush/trace/simd.inl"

namespace underbrush::trace {
namespace {

constexpr size_t kFour = 4;
typedef double D __attribute__((vector_size(32)));
typedef int64_t L __attribute__((vector_size(32)));
typedef double D2 __attribute__((vector_size(16), aligned(8), may_alias));
typedef double D4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef float F4 __attribute__((vector_size(16), aligned(4), may_alias));

inline D every(double a) { return D{a, a, a, a}; }
inline D absolute(D a) { return (D)((L)a & 0x7fffffffffffffff); }
inline D pick(L mask, D yes, D no) { return mask ? yes : no; }
inline D to_double(F4 a) { return __builtin_convertvector(a, D); }
#if defined(__AVX2__)
inline D square_root(D a) { return _mm256_sqrt_pd(a); }
inline unsigned bits(L mask) { return unsigned(_mm256_movemask_pd((__m256d)mask)); }
#else
inline D square_root(D a) {
  D r;
  for (int k = 0; k < 4; ++k) r[k] = __builtin_sqrt(a[k]);
  return r;
}
inline unsigned bits(L mask) {
  return unsigned(mask[0] & 1) | unsigned(mask[1] & 2) | unsigned(mask[2] & 4) |
         unsigned(mask[3] & 8);
}
#endif

// Transposes rows to columns or columns to rows.
inline void transpose(D x[4]) {
  const D a = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6);
  const D b = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7);
  const D c = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6);
  const D d = __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);
  x[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  x[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  x[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  x[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

// The rays of four candidates in their models' frames, in columns.
struct PlacedRays {
  D o[3], d[3], scale, tau2;
};

// Four candidates that are decided together. Where fewer are left, the last one is repeated.
struct Quad {
  uint32_t index[kFour];
  size_t count;
};

// Takes the candidates from `from` on; `index_of` numbers them.
template <class IndexOf>
inline Quad quad_of(size_t from, size_t end, IndexOf index_of) {
  Quad q;
  q.count = end - from < kFour ? end - from : kFour;
  for (size_t k = 0; k < kFour; ++k) q.index[k] = index_of(from + (k < q.count ? k : q.count - 1));
  return q;
}

// Decides candidates four at a time. If kMet, all are known to be met.
template <bool kMet>
class CandidateQuads {
 public:
  CandidateQuads(const View& view, const Batch& batch, const Candidate* list, Intersection* out)
      : view_(view), batch_(batch), list_(list), out_(out) {}

  const InstanceTransform& at_instance(uint32_t instance) {
    if (instance != instance_) {
      at_ = transform_of(view_, instance);
      instance_ = instance;
    }
    return at_;
  }

  void decide(uint32_t index) { answer(index) = intersect_placed(view_, batch_, list_[index]); }

  void decide_ellipsoids(const Quad& q) {
    D e[3][kFour];  // rows: mean, Σ xx; Σ xy xz yy yz; κ, unused, Σ zz, p
    uint32_t element[kFour];
    static_assert(offsetof(elements::Ellipsoid, covariance) == 12 &&
                  offsetof(elements::Ellipsoid, hit) == 36);
    for (size_t k = 0; k < kFour; ++k) {
      const Candidate& c = list_[q.index[k]];
      element[k] = c.element;
      const ModelView& model = *at_instance(c.instance).model;
      const elements::Ellipsoid& of = model.ellipsoids[c.element - model.triangle_count];
      const float* from = reinterpret_cast<const float*>(&of);
      e[0][k] = to_double(*reinterpret_cast<const F4*>(from));
      e[1][k] = to_double(*reinterpret_cast<const F4*>(from + 4));
      F4 last = *reinterpret_cast<const F4*>(from + 6);
      last[0] = of.density_per_m;
      e[2][k] = to_double(last);
    }
    const PlacedRays r = rays_of(q.index);
    for (auto& row : e) transpose(row);
    const D covariance[6] = {e[0][3], e[1][0], e[1][1], e[1][2], e[1][3], e[2][2]};
    const Approach<D> a = approach_of(r.o, r.d, e[0], covariance);
    const D sigma = square_root(a.sigma2), density = e[2][0], zero{};
    D p = e[2][3];
    if (bits(density > zero)) p = pick(density > zero, opacity_of(density, sigma, a.delta2), p);
    write(q, element, a.delta2 <= r.tau2, r.scale, a.t, sigma, a.delta2, p);
  }

  // Decides triangles of a mesh.
  void decide_triangles(const Quad& q, const TrianglePlace* const place[kFour]) {
    const TrianglePlace &a = *place[0], &b = *place[1], &c = *place[2], &d = *place[3];
    Triangles t;
    for (size_t k = 0; k < kFour; ++k) t.mesh[k] = place[k]->mesh, t.element[k] = place[k]->element;
    t.p = D{a.hit->p, b.hit->p, c.hit->p, d.hit->p};
    for (int v = 0; v < 3; ++v) {
      t.load(v, a.corner[v], b.corner[v], c.corner[v], d.corner[v], 1);
    }
    decide_triangles(q, t);
  }

  // Decides triangles that are given by their places in blocks. A packet has just read its blocks,
  // and the meshes are far away.
  void decide_triangles(const Quad& q) {
    Triangles t;
    t.p = every(1);
    const float* first[kFour];
    const uint8_t* corner[kFour];
    for (size_t k = 0; k < kFour; ++k) {
      const Candidate& c = list_[q.index[k]];
      const InstanceTransform& at = at_instance(c.instance);
      const uint32_t place = c.element & ~kInBlock, lane = place / 2 % kWidth, which = place % 2;
      const TriangleBlock& block = at.triangles[place / (2 * kWidth)];
      const uint32_t element = block.element[which][lane];
      corner[k] = kTurns[which][element >> kTurnShift];
      first[k] = &block.corner[0][0][lane];
      t.element[k] = element & kElementMask;
      const bool on_ground = t.element[k] < at.model->ground_count;
      t.mesh[k] = on_ground ? &at.model->ground : &at.model->surface;
      if (block.accept_below[which][lane] == kAlways) continue;
      t.p[k] = t.mesh[k]->hit[t.element[k] - (on_ground ? 0 : at.model->ground_count)].p;
    }
    for (int v = 0; v < 3; ++v) {
      const auto at = [&](int k) { return first[k] + 3 * kWidth * corner[k][v]; };
      t.load(v, at(0), at(1), at(2), at(3), kWidth);
    }
    decide_triangles(q, t);
  }

 private:
  struct Triangles {
    D corner[3][3];
    const ModelView::Mesh* mesh[kFour];
    uint32_t element[kFour];
    D p;

    // Loads corner v of each, whose coordinates are `stride` apart.
    void load(int v, const float* a, const float* b, const float* c, const float* d, int stride) {
      for (int k = 0; k < 3; ++k) {
        const int at = k * stride;
        corner[v][k] = to_double(F4{a[at], b[at], c[at], d[at]});
      }
    }
    template <class Member>
    D of_mesh(Member member) const {
      return D{mesh[0]->*member, mesh[1]->*member, mesh[2]->*member, mesh[3]->*member};
    }
  };

  void decide_triangles(const Quad& q, const Triangles& t) {
    D sigma = t.of_mesh(&ModelView::Mesh::sigma_m);
    const D roughness = t.of_mesh(&ModelView::Mesh::roughness_m);
    const PlacedRays r = rays_of(q.index);
    const L rough = roughness > 0.0;
    if (bits(rough)) {
      const D sigma2 = rough_sigma2(sigma, roughness, t.corner[0], t.corner[1], t.corner[2], r.d);
      sigma = pick(rough, square_root(sigma2), sigma);
    }
    const TriangleTest test = cross(r, t.corner);
    write(q, t.element, test.inside, r.scale, test.t, sigma, D{}, t.p);
    // Rays that plain arithmetic finds on an edge are decided by the exact test.
    for (size_t k = 0; test.certain != 0xf && k < q.count; ++k) {
      if (!(test.certain >> k & 1)) decide(q.index[k]);
    }
  }

  struct TriangleTest {
    L inside;
    D t;
    unsigned certain;
  };

  static TriangleTest cross(const PlacedRays& r, const D corner[3][3]) {
    // The direction's greatest component becomes the third axis, as in `crossing`.
    const D x = absolute(r.d[0]), y = absolute(r.d[1]), z = absolute(r.d[2]);
    const L is_y = y > x, is_z = z > pick(is_y, y, x);
    const auto turn = [&](const D from[3], D to[3]) {
      to[0] = pick(is_z, from[0], pick(is_y, from[2], from[1]));
      to[1] = pick(is_z, from[1], pick(is_y, from[0], from[2]));
      to[2] = pick(is_z, from[2], pick(is_y, from[1], from[0]));
    };
    D o[3], d[3], corners[3][3];
    turn(r.o, o);
    turn(r.d, d);
    for (int v = 0; v < 3; ++v) turn(corner[v], corners[v]);
    const Sheared<D> s = shear(o, d, corners);
    D weight[3];
    const D zero{};
    L above = zero == zero, below = above, sure = above;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const D xy = s.x[i] * s.y[j], zw = s.x[j] * s.y[i];
      weight[k] = xy - zw;
      if (kMet) continue;
      above &= weight[k] >= zero;
      below &= weight[k] <= zero;
      sure &= absolute(weight[k]) > 1e-15 * (absolute(xy) + absolute(zw));
    }
    return {above | below, range_at(s, weight, d[2]), bits(sure)};
  }

  PlacedRays rays_of(const uint32_t index[kFour]) {
    D o[kFour];
    D2 d_yz[kFour];  // o has o x y z, d x
    const Candidate &c0 = list_[index[0]], &c1 = list_[index[1]], &c2 = list_[index[2]],
                    &c3 = list_[index[3]];
    const InstanceTransform& at = at_instance(c0.instance);
    const bool one = ((c0.instance ^ c1.instance) | (c0.instance ^ c2.instance) |
                      (c0.instance ^ c3.instance)) == 0;
    D scale = every(at.scale_tau2[0]), tau2 = every(at.scale_tau2[1]);
    if (one && at.is_translation) {
      const D translation = *reinterpret_cast<const D4*>(at.translation);
      for (size_t k = 0; k < kFour; ++k) {
        const double* ray = batch_.rays[list_[index[k]].ray].origin.data();
        o[k] = *reinterpret_cast<const D4*>(ray) - translation;
        d_yz[k] = *reinterpret_cast<const D2*>(ray + 4);
      }
    } else {
      for (size_t k = 0; k < kFour; ++k) {
        const Candidate& c = list_[index[k]];
        double placed[6];
        place_ray(view_, batch_, c, placed, placed + 3);
        o[k] = *reinterpret_cast<const D4*>(placed);
        d_yz[k] = *reinterpret_cast<const D2*>(placed + 4);
        scale[k] = at_instance(c.instance).scale_tau2[0];
        tau2[k] = at_instance(c.instance).scale_tau2[1];
      }
    }
    transpose(o);
    const D y0z0y2z2 = __builtin_shufflevector(d_yz[0], d_yz[2], 0, 1, 2, 3);
    const D y1z1y3z3 = __builtin_shufflevector(d_yz[1], d_yz[3], 0, 1, 2, 3);
    return {{o[0], o[1], o[2]},
            {o[3], __builtin_shufflevector(y0z0y2z2, y1z1y3z3, 0, 4, 2, 6),
             __builtin_shufflevector(y0z0y2z2, y1z1y3z3, 1, 5, 3, 7)},
            scale,
            tau2};
  }

  Intersection& answer(uint32_t index) const {
    return kMet ? batch_.best[list_[index].ray] : out_[index];
  }

  void write(const Quad& q, const uint32_t element[kFour], L inside, D scale, D t, D sigma,
             D delta2, D p) {
    const D range = t * scale;
    D row[kFour] = {range, sigma * scale, delta2, p};
    unsigned met = 0xf;
    if (!kMet) {
      inside &= (range >= batch_.limits.min_m) & (range <= batch_.limits.max_m);
      for (D& column : row) column = (D)((L)column & inside);
      met = bits(inside);
    }
    transpose(row);
    for (size_t k = 0; k < q.count; ++k) {
      const Candidate& c = list_[q.index[k]];
      Intersection& to = answer(q.index[k]);
      *reinterpret_cast<D4*>(&to.t_m) = row[k];
      const bool is_met = met >> k & 1;
      to.element = is_met ? element[k] : Intersection::kNone;
      to.instance = is_met ? c.instance : 0;
    }
  }

  const View& view_;
  const Batch& batch_;
  const Candidate* list_;
  Intersection* out_;
  InstanceTransform at_{};
  uint32_t instance_ = Intersection::kNone;
};

void intersect_run(const View& view, const Batch& batch, const Candidate* list, size_t count,
                   Intersection* out) {
  CandidatesByKind sorted;
  split_by_kind(view, batch, list, count, sorted);
  CandidateQuads<false> quads(view, batch, list, out);
  const auto ellipsoid = [&](size_t k) { return sorted.ellipsoid[k]; };
  for (size_t k = 0; k < sorted.ellipsoids; k += kFour) {
    quads.decide_ellipsoids(quad_of(k, sorted.ellipsoids, ellipsoid));
  }
  for (size_t k = 0; k < sorted.alones; ++k) quads.decide(sorted.alone[k]);
  for (size_t k = 0; k < sorted.triangles; k += kFour) {
    const auto triangle = [&](size_t i) { return sorted.triangle[i]; };
    const TrianglePlace* place[kFour];
    for (size_t i = 0; i < kFour; ++i) {
      place[i] = &sorted.of_triangle[k + i < sorted.triangles ? k + i : sorted.triangles - 1];
    }
    quads.decide_triangles(quad_of(k, sorted.triangles, triangle), place);
  }
}

[[maybe_unused]] void intersect_many(const View& view, const Batch& batch, const Candidate* list,
                                     size_t count, Intersection* out) {
  for (size_t from = 0; from < count; from += kRun) {
    intersect_run(view, batch, list + from, count - from < kRun ? count - from : kRun, out + from);
  }
}

// Prefetches a ray and its answer. One prefetch is enough for each, because neighbours share their
// lines.
inline void prefetch_ray(const Batch& batch, const Candidate& c) {
  __builtin_prefetch(batch.rays + c.ray);
  __builtin_prefetch(batch.best + c.ray, 1);
}

[[maybe_unused]] void answer_known(const View& view, const Batch& batch) {
  constexpr size_t kAhead = 32;
  const Candidate *ellipsoid = batch.known, *end = batch.known + kBatchRays;
  const auto itself = [](size_t k) { return uint32_t(k); };
  {
    CandidateQuads<true> quads(view, batch, ellipsoid, nullptr);
    for (size_t from = 0; from < batch.known_ellipsoids; from += kRun) {
      const size_t left = batch.known_ellipsoids - from, to = from + (left < kRun ? left : kRun);
      for (size_t k = from; k < to; ++k) {
        const Candidate& c = ellipsoid[k];
        prefetch_ray(batch, c);
        prefetch_ellipsoid(*quads.at_instance(c.instance).model, c.element);
      }
      for (size_t k = from; k < to; k += kFour) quads.decide_ellipsoids(quad_of(k, to, itself));
    }
  }
  const size_t count = batch.known_triangles;
  const Candidate* triangle = end - count;
  CandidateQuads<true> quads(view, batch, triangle, nullptr);
  for (size_t k = 0; k < count; k += kFour) {
    if (k + kAhead + kFour <= count) {
      for (size_t i = 0; i < kFour; ++i) prefetch_ray(batch, triangle[k + kAhead + i]);
    }
    quads.decide_triangles(quad_of(k, count, itself));
  }
}

}  // namespace
}  // namespace underbrush::trace
