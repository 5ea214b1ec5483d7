// `intersect` for many rays and elements, four elements of one kind at a time. kernel_*.cpp use
// this file.
#pragma once
#include <cstddef>
#include <cstdint>

#include "underbrush/trace/exact.inl"
#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/many_kinds.inl"
#include "underbrush/trace/simd.inl"
#include "underbrush/trace/simd_double.inl"

namespace underbrush::trace {
namespace {

// The rays of four candidates in their models' frames, in columns.
struct PlacedRays {
  D o[3], d[3], scale, tau2;
};

// Four candidates that are decided together, and where their answers go. Of those beyond `count`
// nothing is written.
struct Quad {
  const Candidate* of[kFour];
  Intersection* to[kFour];
  size_t count;
};

// Decides candidates four at a time. If kMet, all are known to be met.
template <bool kMet>
class CandidateQuads {
 public:
  CandidateQuads(const View& view, const Batch& batch) : view_(view), batch_(batch) {}

  const InstanceTransform& at_instance(uint32_t instance) {
    if (instance != instance_) {
      at_ = transform_of(view_, instance);
      instance_ = instance;
    }
    return at_;
  }

  void decide_ellipsoids(const Quad& q) {
    D e[3][kFour];       // rows: mean, Σ xx; Σ xy xz yy yz; κ, unused, Σ zz, p
    D level{}, slope{};  // of `LeafAngleDistribution`
    uint32_t element[kFour];
    static_assert(offsetof(elements::Ellipsoid, covariance) == 12 &&
                  offsetof(elements::Ellipsoid, hit) == 36);
    for (size_t k = 0; k < kFour; ++k) {
      const Candidate& c = *q.of[k];
      element[k] = c.element;
      const ModelView& model = *at_instance(c.instance).model;
      const elements::Ellipsoid& of = model.ellipsoids[place_of(model, elements::Kind::kEllipsoid,
                                                                c.element - model.triangle_count)];
      const float* from = reinterpret_cast<const float*>(&of);
      e[0][k] = to_double(*reinterpret_cast<const F4*>(from));
      e[1][k] = to_double(*reinterpret_cast<const F4*>(from + 4));
      F4 last = *reinterpret_cast<const F4*>(from + 6);
      last[0] = of.density_per_m;
      level[k] = model.leaf_level;
      slope[k] = model.leaf_slope;
      e[2][k] = to_double(last);
    }
    const PlacedRays r = rays_of(q);
    for (auto& row : e) transpose(row);
    const D covariance[6] = {e[0][3], e[1][0], e[1][1], e[1][2], e[1][3], e[2][2]};
    const Approach<D> a = approach_of(r.o, r.d, e[0], covariance);
    const D sigma = square_root(a.sigma2), density = e[2][0], zero{};
    D p = e[2][3];
    if (const L dense = less(zero, density); bits(dense)) {
      const D leaves = square_root(level + slope * (r.d[2] * r.d[2]));
      p = pick(dense, opacity_of(density * leaves, sigma, a.delta2), p);
    }
    write(q, element, le(a.delta2, r.tau2), r.scale, a.t, sigma, a.delta2, p);
  }

  // Decides triangles of a mesh.
  void decide_triangles(const Quad& q, const TrianglePlace* const place[kFour]) {
    Triangles t;
    for (size_t k = 0; k < kFour; ++k) {
      const TrianglePlace& of = *place[k];
      t.set(k, of.mesh, of.element, of.hit - of.mesh->hit, of.hit->p);
      t.set_corners(k, row_of(of.corner[0], 1), row_of(of.corner[1], 1), row_of(of.corner[2], 1));
    }
    decide_triangles(q, t);
  }

  // Decides triangles that are given by their places in blocks. A packet has just read its blocks,
  // and the meshes are far away.
  void decide_triangles(const Quad& q) {
    Triangles t;
    for (size_t k = 0; k < kFour; ++k) {
      const Candidate& c = *q.of[k];
      const InstanceTransform& at = at_instance(c.instance);
      const uint32_t place = c.element & ~kInBlock, lane = place / 2 % kWidth, which = place % 2;
      const TriangleBlock& block = at.triangles[place / (2 * kWidth)];
      const uint32_t turned = block.element[which][lane], element = turned & kElementMask;
      const bool on_ground = element < at.model->ground_count;
      const ModelView::Mesh* mesh = on_ground ? &at.model->ground : &at.model->surface;
      const uint32_t triangle = on_ground ? place_of(*at.model, elements::Kind::kGround, element)
                                          : place_of(*at.model, elements::Kind::kSurface,
                                                     element - at.model->ground_count);
      const bool always = block.accept_below[which][lane] == kAlways;
      t.set(k, mesh, element, triangle, always ? 1 : mesh->hit[triangle].p);
      const float* first = &block.corner[0][0][lane];
      const int32_t* corner = kCornerPlaces.of[which][turned >> kTurnShift];
      t.set_corners(k, row_of(first + corner[0], kWidth), row_of(first + corner[1], kWidth),
                    row_of(first + corner[2], kWidth));
    }
    decide_triangles(q, t);
  }

 private:
  // Where the corners of a triangle in the order of its mesh lie in a block, in floats from the
  // first corner of its pair.
  struct CornerPlaces {
    int32_t of[2][3][3];
    constexpr CornerPlaces() : of{} {
      for (int which = 0; which < 2; ++which) {
        for (int turn = 0; turn < 3; ++turn) {
          for (int v = 0; v < 3; ++v) of[which][turn][v] = 3 * kWidth * kTurns[which][turn][v];
        }
      }
    }
  };
  static constexpr CornerPlaces kCornerPlaces{};

  // Loads x, y and z of a corner, which are `stride` floats apart.
  static D row_of(const float* at, int stride) {
    return to_double(F4{at[0], at[stride], at[2 * stride], 0});
  }

  struct Triangles {
    D corner[3][kFour];  // rows: x y z; of the last two corners only unless kMet
    D normal[kFour];     // rows: z x y
    const ModelView::Mesh* mesh[kFour];
    uint32_t element[kFour];
    D p, roughness;

    // Sets triangle `at` of a mesh, which is element `number` of the model.
    void set(size_t k, const ModelView::Mesh* of, uint32_t number, ptrdiff_t at, float hit) {
      mesh[k] = of;
      element[k] = number;
      p[k] = hit;
      roughness[k] = of->roughness ? double(of->roughness[at]) : of->roughness_m;
    }
    void set_corners(size_t k, D a, D b, D c) {
      corner[0][k] = a;
      if (!kMet) corner[1][k] = b, corner[2][k] = c;
      const D u = b - a, v = c - a;
      normal[k] = u * __builtin_shufflevector(v, v, 1, 2, 0, 3) -
                  __builtin_shufflevector(u, u, 1, 2, 0, 3) * v;
    }
    template <class Member>
    D of_mesh(Member member) const {
      return D{mesh[0]->*member, mesh[1]->*member, mesh[2]->*member, mesh[3]->*member};
    }
  };

  void decide_triangles(const Quad& q, Triangles& t) {
    const PlacedRays r = rays_of(q);
    transpose(t.corner[0]);
    transpose(t.normal);
    const D normal[3] = {t.normal[1], t.normal[2], t.normal[0]};
    const D along = dot(normal, r.d);
    D sigma = t.of_mesh(&ModelView::Mesh::sigma_m);
    const L rough = less(D{}, t.roughness);
    if (bits(rough)) {
      sigma = pick(rough, square_root(rough_sigma2(sigma, t.roughness, normal, along)), sigma);
    }
    L inside{};
    unsigned certain = 0xf;
    if (!kMet) inside = is_inside(r, t, certain);
    write(q, t.element, inside, r.scale, range_to_plane(r.o, t.corner[0], normal, along), sigma,
          D{}, t.p);
    // Rays that plain arithmetic finds on an edge are decided by the exact test.
    for (size_t k = 0; certain != 0xf && k < q.count; ++k) {
      if (!(certain >> k & 1)) *q.to[k] = intersect_placed(view_, batch_, *q.of[k]);
    }
  }

  // Finds the rays that cross their triangles, and those for which this is certain.
  static L is_inside(const PlacedRays& r, Triangles& t, unsigned& certain) {
    transpose(t.corner[1]);
    transpose(t.corner[2]);
    // The direction's greatest component becomes the third axis, as in `crossing`.
    const D x = absolute(r.d[0]), y = absolute(r.d[1]), z = absolute(r.d[2]);
    const L is_y = less(x, y), is_z = less(pick(is_y, y, x), z);
    const auto turn = [&](const D from[3], D to[3]) {
      to[0] = pick(is_z, from[0], pick(is_y, from[2], from[1]));
      to[1] = pick(is_z, from[1], pick(is_y, from[0], from[2]));
      to[2] = pick(is_z, from[2], pick(is_y, from[1], from[0]));
    };
    D o[3], d[3], corner[3][3];
    turn(r.o, o);
    turn(r.d, d);
    for (int v = 0; v < 3; ++v) turn(t.corner[v], corner[v]);
    const Sheared<D> s = shear(o, d, corner);
    const D zero{};
    L above = le(zero, zero), below = above, sure = above;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const D xy = s.x[i] * s.y[j], zw = s.x[j] * s.y[i], weight = xy - zw;
      above &= le(zero, weight);
      below &= le(weight, zero);
      sure &= less(1e-15 * (absolute(xy) + absolute(zw)), absolute(weight));
    }
    certain = bits(sure);
    return above | below;
  }

  PlacedRays rays_of(const Quad& q) {
    D o[kFour];
    D2 d_yz[kFour];  // o has o x y z, d x
    const Candidate &c0 = *q.of[0], &c1 = *q.of[1], &c2 = *q.of[2], &c3 = *q.of[3];
    const InstanceTransform& at = at_instance(c0.instance);
    const bool one = ((c0.instance ^ c1.instance) | (c0.instance ^ c2.instance) |
                      (c0.instance ^ c3.instance)) == 0;
    D scale = every(at.scale_tau2[0]), tau2 = every(at.scale_tau2[1]);
    if (one && at.is_translation) {
      const D translation = *reinterpret_cast<const D4*>(at.translation);
      for (size_t k = 0; k < kFour; ++k) {
        const double* ray = batch_.rays[q.of[k]->ray].origin.data();
        o[k] = *reinterpret_cast<const D4*>(ray) - translation;
        d_yz[k] = *reinterpret_cast<const D2*>(ray + 4);
      }
    } else {
      for (size_t k = 0; k < kFour; ++k) {
        const Candidate& c = *q.of[k];
        double placed[6];
        place_ray(view_, batch_, c, placed, placed + 3);
        o[k] = *reinterpret_cast<const D4*>(placed);
        d_yz[k] = *reinterpret_cast<const D2*>(placed + 4);
        scale[k] = at_instance(c.instance).scale_tau2[0];
        tau2[k] = at_instance(c.instance).scale_tau2[1];
      }
    }
    transpose(o);
    const D y0z0y2z2 = joined(d_yz[0], d_yz[2]), y1z1y3z3 = joined(d_yz[1], d_yz[3]);
    return {{o[0], o[1], o[2]},
            {o[3], first_lanes(y0z0y2z2, y1z1y3z3), second_lanes(y0z0y2z2, y1z1y3z3)},
            scale,
            tau2};
  }

  void write(const Quad& q, const uint32_t element[kFour], L inside, D scale, D t, D sigma,
             D delta2, D p) {
    const D range = t * scale;
    D row[kFour] = {range, sigma * scale, delta2, p};
    unsigned met = 0xf;
    if (!kMet) {
      inside &= le(every(batch_.limits.min_m), range) & le(range, every(batch_.limits.max_m));
      for (D& column : row) column = (D)((L)column & inside);
      met = bits(inside);
    }
    transpose(row);
    for (size_t k = 0; k < q.count; ++k) {
      Intersection& to = *q.to[k];
      *reinterpret_cast<D4*>(&to.t_m) = row[k];
      const bool is_met = met >> k & 1;
      to.element = is_met ? element[k] : Intersection::kNone;
      to.instance = is_met ? q.of[k]->instance : 0;
    }
  }

  const View& view_;
  const Batch& batch_;
  InstanceTransform at_{};
  uint32_t instance_ = Intersection::kNone;
};

void intersect_run(const View& view, const Batch& batch, const Candidate* list, size_t count,
                   Intersection* out) {
  CandidatesByKind sorted;
  split_by_kind(view, batch, list, count, sorted);
  CandidateQuads<false> quads(view, batch);
  const auto quad_at = [&](const uint32_t* index, size_t left) {
    Quad q;
    q.count = left < kFour ? left : kFour;
    for (size_t k = 0; k < kFour; ++k) {
      const uint32_t i = index[k < q.count ? k : q.count - 1];
      q.of[k] = list + i;
      q.to[k] = out + i;
    }
    return q;
  };
  for (size_t k = 0; k < sorted.ellipsoids; k += kFour) {
    quads.decide_ellipsoids(quad_at(sorted.ellipsoid + k, sorted.ellipsoids - k));
  }
  for (size_t k = 0; k < sorted.alones; ++k) {
    const uint32_t i = sorted.alone[k];
    out[i] = intersect_placed(view, batch, list[i]);
  }
  for (size_t k = 0; k < sorted.triangles; k += kFour) {
    const TrianglePlace* place[kFour];
    for (size_t i = 0; i < kFour; ++i) {
      place[i] = &sorted.of_triangle[k + i < sorted.triangles ? k + i : sorted.triangles - 1];
    }
    quads.decide_triangles(quad_at(sorted.triangle + k, sorted.triangles - k), place);
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

// The quad of known candidates from `from` on; there are `left`, and then copies of the last.
inline Quad known_quad(const Batch& batch, const Candidate* from, size_t left) {
  Quad q;
  q.count = left < kFour ? left : kFour;
  for (size_t k = 0; k < kFour; ++k) {
    q.of[k] = from + k;
    q.to[k] = batch.best + from[k].ray;
  }
  return q;
}

[[maybe_unused]] void answer_known(const View& view, const Batch& batch) {
  static_assert(kFour <= kKnownBeyond + 1);
  CandidateQuads<true> quads(view, batch);
  for (Known* known : {batch.ellipsoids, batch.triangles}) {
    if (known->count == 0) continue;
    for (size_t k = 0; k < kKnownBeyond; ++k)
      known->of[known->count + k] = known->of[known->count - 1];
  }
  const Candidate* ellipsoid = batch.ellipsoids->of;
  for (size_t from = 0; from < batch.ellipsoids->count; from += kRun) {
    const size_t left = batch.ellipsoids->count - from, to = from + (left < kRun ? left : kRun);
    for (size_t k = from; k < to; ++k) {
      const Candidate& c = ellipsoid[k];
      prefetch_ray(batch, c);
      prefetch_ellipsoid(*quads.at_instance(c.instance).model, c.element);
    }
    for (size_t k = from; k < to; k += kFour) {
      quads.decide_ellipsoids(known_quad(batch, ellipsoid + k, to - k));
    }
  }
  constexpr size_t kAhead = 32;
  const Candidate* triangle = batch.triangles->of;
  const size_t count = batch.triangles->count;
  for (size_t k = 0; k < count; k += kFour) {
    if (k + kAhead + kFour <= count) {
      for (size_t i = 0; i < kFour; ++i) prefetch_ray(batch, triangle[k + kAhead + i]);
    }
    quads.decide_triangles(known_quad(batch, triangle + k, count - k));
  }
}

}  // namespace
}  // namespace underbrush::trace
