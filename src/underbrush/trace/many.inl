// `intersect` for many rays and elements, four elements of one kind at a time. Answers go to
// out[i], one a candidate, or, if `out` is null, to the best of each candidate's ray. kernel_*.cpp
// use this file.
#pragma once
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "underbrush/trace/exact.inl"
#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/simd.inl"

namespace underbrush::trace {
namespace {

constexpr size_t kFour = 4;
typedef double D __attribute__((vector_size(32)));
typedef int64_t L __attribute__((vector_size(32)));
typedef double D2 __attribute__((vector_size(16), aligned(8), may_alias));
typedef double D4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef float F4 __attribute__((vector_size(16), aligned(4), may_alias));

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

// Up to kRun candidates, with triangles apart from ellipsoids.
constexpr size_t kRun = 256;
struct CandidatesByKind {
  struct Triangle {
    uint32_t index, at;
    const ModelView::Mesh* mesh;
    const float* corner[3];
  } triangle[kRun + 1];
  struct Ellipsoid {
    uint32_t index;
    const elements::Ellipsoid* data;
  } ellipsoid[kRun + 1];
  size_t triangles = 0, ellipsoids = 0;
};

// Sorts candidates by kind, and prefetches their rays and elements.
inline void split_by_kind(const View& view, const Batch& batch, const Candidate* list, size_t count,
                          CandidatesByKind& out) {
  for (size_t i = 0; i < count; ++i) {
    const char* ray = reinterpret_cast<const char*>(batch.rays + list[i].ray);
    __builtin_prefetch(ray);
    __builtin_prefetch(ray + sizeof(Ray) - 1);
    const char* best = reinterpret_cast<const char*>(batch.best + list[i].ray);
    __builtin_prefetch(best, 1);
    __builtin_prefetch(best + sizeof(Intersection) - 1, 1);
    const ModelView& m = view.model_views[view.instances[list[i].instance].model];
    const uint32_t element = list[i].element;
    const bool is_triangle = element < m.triangle_count, on_ground = element < m.ground_count;
    CandidatesByKind::Triangle& t = out.triangle[out.triangles];
    t.index = uint32_t(i);
    t.mesh = on_ground ? &m.ground : &m.surface;
    t.at = element - (on_ground ? 0 : m.ground_count);
    out.ellipsoid[out.ellipsoids] = {uint32_t(i), m.ellipsoids + (element - m.triangle_count)};
    out.triangles += is_triangle;
    out.ellipsoids += !is_triangle;
  }
  for (size_t k = 0; k < out.triangles; ++k) {
    const CandidatesByKind::Triangle& t = out.triangle[k];
    __builtin_prefetch(t.mesh->triangles + 3 * size_t(t.at));
    __builtin_prefetch(t.mesh->hit + t.at);
  }
  for (size_t k = 0; k < out.ellipsoids; ++k) {
    const char* e = reinterpret_cast<const char*>(out.ellipsoid[k].data);
    __builtin_prefetch(e);
    __builtin_prefetch(e + sizeof(elements::Ellipsoid) - 1);
  }
  for (size_t k = 0; k < out.triangles; ++k) {
    CandidatesByKind::Triangle& t = out.triangle[k];
    const uint32_t* corners = t.mesh->triangles + 3 * size_t(t.at);
    for (int v = 0; v < 3; ++v) {
      t.corner[v] = t.mesh->vertices + 3 * size_t(corners[v]);
      __builtin_prefetch(t.corner[v]);
    }
  }
}

// Four candidates that are decided together, with the rays in their models' frames.
struct CandidateQuad {
  uint32_t index[kFour];
  size_t count = 0;
  D first_half[kFour], second_half[kFour];  // rows: o x y z, d x; d y z, scale, τ²
  InstanceTransform at;
  uint32_t instance_of_transform = Intersection::kNone;

  // Adds candidate i and gives its model.
  const ModelView& add(const View& view, const Batch& batch, const Candidate* list, uint32_t i) {
    const Candidate& c = list[i];
    if (c.instance != instance_of_transform) {
      at = transform_of(view, c.instance);
      instance_of_transform = c.instance;
    }
    const double* ray = batch.rays[c.ray].origin.data();
    double placed[6];
    if (!at.is_translation) {
      place_ray(view, batch, c, placed, placed + 3);
      ray = placed;
    }
    first_half[count] = *reinterpret_cast<const D4*>(ray);
    if (at.is_translation) first_half[count] -= *reinterpret_cast<const D4*>(at.translation);
    const D2 d = *reinterpret_cast<const D2*>(ray + 4),
             s = *reinterpret_cast<const D2*>(at.scale_tau2);
    second_half[count] = __builtin_shufflevector(d, s, 0, 1, 2, 3);
    index[count++] = i;
    return *at.model;
  }

  // Gives the columns o, d, scale and τ². Places without a candidate repeat the last one.
  void columns(D o[3], D d[3], D& scale, D& tau2) {
    for (size_t k = count; k < kFour; ++k) {
      first_half[k] = first_half[count - 1];
      second_half[k] = second_half[count - 1];
    }
    transpose(first_half);
    transpose(second_half);
    for (int a = 0; a < 3; ++a) o[a] = first_half[a];
    d[0] = first_half[3];
    d[1] = second_half[0];
    d[2] = second_half[1];
    scale = second_half[2];
    tau2 = second_half[3];
  }

  void write(const Batch& batch, const Candidate* list, L inside, D scale, D t, D sigma, D delta2,
             D p, Intersection* out) {
    D row[4] = {t * scale, sigma * scale, delta2, p};
    inside &= (row[0] >= batch.limits.min_m) & (row[0] <= batch.limits.max_m);
    transpose(row);
    const unsigned met = bits(inside);
    for (size_t k = 0; k < count; ++k) {
      const Candidate& c = list[index[k]];
      Intersection& to = out ? out[index[k]] : batch.best[c.ray];
      const bool is_met = met >> k & 1;
      *reinterpret_cast<D4*>(&to.t_m) = is_met ? row[k] : D{};
      to.element = is_met ? c.element : Intersection::kNone;
      to.instance = is_met ? c.instance : 0;
    }
    count = 0;
  }
};

struct Ellipsoids : CandidateQuad {
  D e[3][kFour];  // rows: mean, Σ xx; Σ xy xz yy yz; κ, unused, Σ zz, p

  void add(const View& view, const Batch& batch, const Candidate* list,
           const CandidatesByKind::Ellipsoid& entry, Intersection* out) {
    const size_t k = count;
    const ModelView& m = CandidateQuad::add(view, batch, list, entry.index);
    if (m.voxels) {
      const Candidate& c = list[entry.index];
      (out ? out[entry.index] : batch.best[c.ray]) = intersect_placed(view, batch, c);
      --count;
      return;
    }
    static_assert(offsetof(elements::Ellipsoid, covariance) == 12 &&
                  offsetof(elements::Ellipsoid, hit) == 36);
    const float* from = reinterpret_cast<const float*>(entry.data);
    e[0][k] = to_double(*reinterpret_cast<const F4*>(from));
    e[1][k] = to_double(*reinterpret_cast<const F4*>(from + 4));
    e[2][k] = to_double(*reinterpret_cast<const F4*>(from + 6));
    e[2][k][0] = double(entry.data->density_per_m);
    if (count == kFour) decide(batch, list, out);
  }

  void decide(const Batch& batch, const Candidate* list, Intersection* out) {
    if (count == 0) return;
    D o[3], d[3], scale, tau2;
    for (size_t k = count; k < kFour; ++k) {
      for (auto& row : e) row[k] = row[count - 1];
    }
    columns(o, d, scale, tau2);
    for (auto& row : e) transpose(row);
    const D covariance[6] = {e[0][3], e[1][0], e[1][1], e[1][2], e[1][3], e[2][2]};
    const Approach<D> a = approach_of(o, d, e[0], covariance);
    const D sigma = square_root(a.sigma2), density = e[2][0], zero{};
    D p = e[2][3];
    if (bits(density > zero)) p = pick(density > zero, opacity_of(density, sigma, a.delta2), p);
    write(batch, list, a.delta2 <= tau2, scale, a.t, sigma, a.delta2, p, out);
  }
};

struct Triangles : CandidateQuad {
  D corner[3][kFour];  // rows: x y z, then unused, p and σ for the three corners

  void add(const View& view, const Batch& batch, const Candidate* list,
           const CandidatesByKind::Triangle& t, Intersection* out) {
    const size_t k = count;
    CandidateQuad::add(view, batch, list, t.index);
    const float *a = t.corner[0], *b = t.corner[1], *c = t.corner[2];
    corner[0][k] = D{a[0], a[1], a[2], a[2]};
    corner[1][k] = D{b[0], b[1], b[2], t.mesh->hit[t.at].p};
    const double d[3] = {first_half[k][3], second_half[k][0], second_half[k][1]};
    const double sigma = rough_sigma(t.mesh->sigma_m, t.mesh->roughness_m, a, b, c, d);
    corner[2][k] = D{c[0], c[1], c[2], sigma};
    if (count == kFour) decide(view, batch, list, out);
  }

  void decide(const View& view, const Batch& batch, const Candidate* list, Intersection* out) {
    if (count == 0) return;
    D o[3], d[3], scale, tau2;
    for (size_t k = count; k < kFour; ++k) {
      for (auto& row : corner) row[k] = row[count - 1];
    }
    columns(o, d, scale, tau2);
    for (auto& row : corner) transpose(row);
    // The direction's greatest component becomes the third axis, as in `crossing`.
    const D x = absolute(d[0]), y = absolute(d[1]), z = absolute(d[2]);
    const L is_y = y > x, is_z = z > pick(is_y, y, x);
    const auto turn = [&](D v[3]) {
      const D a = v[0], b = v[1], c = v[2];
      v[0] = pick(is_z, a, pick(is_y, c, b));
      v[1] = pick(is_z, b, pick(is_y, a, c));
      v[2] = pick(is_z, c, pick(is_y, b, a));
    };
    turn(o);
    turn(d);
    for (auto& v : corner) turn(v);
    const D three[3][3] = {{corner[0][0], corner[0][1], corner[0][2]},
                           {corner[1][0], corner[1][1], corner[1][2]},
                           {corner[2][0], corner[2][1], corner[2][2]}};
    const Sheared<D> s = shear(o, d, three);
    const D zero{};
    D weight[3];
    L above = zero == zero, below = above, sure = above;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const D xy = s.x[i] * s.y[j], zw = s.x[j] * s.y[i];
      weight[k] = xy - zw;
      above &= weight[k] >= zero;
      below &= weight[k] <= zero;
      sure &= absolute(weight[k]) > 1e-15 * (absolute(xy) + absolute(zw));
    }
    const unsigned certain = bits(sure);
    const size_t written = count;
    write(batch, list, above | below, scale, range_at(s, weight, d[2]), corner[2][3], zero,
          corner[1][3], out);
    if (certain == 0xf) return;
    for (size_t k = 0; k < written; ++k) {
      // Rays that plain arithmetic finds on an edge are decided by the exact test.
      if (certain >> k & 1) continue;
      const Candidate& c = list[index[k]];
      (out ? out[index[k]] : batch.best[c.ray]) = intersect_placed(view, batch, c);
    }
  }
};

[[maybe_unused]] void intersect_run(const View& view, const Batch& batch, const Candidate* list,
                                    size_t count, Intersection* out) {
  CandidatesByKind sorted;
  split_by_kind(view, batch, list, count, sorted);
  Ellipsoids ellipsoids;
  for (size_t k = 0; k < sorted.ellipsoids; ++k) {
    ellipsoids.add(view, batch, list, sorted.ellipsoid[k], out);
  }
  ellipsoids.decide(batch, list, out);
  Triangles triangles;
  for (size_t k = 0; k < sorted.triangles; ++k) {
    triangles.add(view, batch, list, sorted.triangle[k], out);
  }
  triangles.decide(view, batch, list, out);
}

[[maybe_unused]] void intersect_many(const View& view, const Batch& batch, const Candidate* list,
                                     size_t count, Intersection* out) {
  for (size_t from = 0; from < count; from += kRun) {
    intersect_run(view, batch, list + from, count - from < kRun ? count - from : kRun,
                  out ? out + from : nullptr);
  }
}

}  // namespace
}  // namespace underbrush::trace
