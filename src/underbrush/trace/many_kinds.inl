// Sorts pairs of a ray and an element by the kind of the element, and finds the elements in memory.
// kernel_*.cpp use this file.
#pragma once
#include <cstddef>
#include <cstdint>

#include "underbrush/trace/kernel.hpp"

namespace underbrush::trace {
namespace {

// The place in the arrays of a model of the element with this number among those of its kind.
inline uint32_t place_of(const ModelView& model, elements::Kind kind, uint32_t number) {
  const ModelView::Numbers& all = model.numbers[int(kind)];
  if (!all.first) return number;
  uint32_t begin = 0;
  for (uint32_t count = all.count; count > 1;) {
    const uint32_t half = count / 2;
    if (all.first[begin + half] <= number) begin += half;
    count -= half;
  }
  return begin;
}

// A triangle of a mesh.
struct TrianglePlace {
  const float* corner[3];
  const ModelView::Mesh* mesh;
  const elements::HitCount* hit;
  uint32_t element;
};

inline TrianglePlace in_mesh(const ModelView& model, uint32_t element) {
  const bool on_ground = element < model.ground_count;
  TrianglePlace t;
  t.mesh = on_ground ? &model.ground : &model.surface;
  const size_t at = on_ground
                        ? place_of(model, elements::Kind::kGround, element)
                        : place_of(model, elements::Kind::kSurface, element - model.ground_count);
  t.hit = t.mesh->hit + at;
  t.element = element;
  const uint32_t* corners = t.mesh->triangles + 3 * at;
  for (int v = 0; v < 3; ++v) t.corner[v] = t.mesh->vertices + 3 * size_t(corners[v]);
  return t;
}

inline void prefetch_ellipsoid(const ModelView& model, uint32_t element) {
  const elements::Ellipsoid* e = model.ellipsoids + place_of(model, elements::Kind::kEllipsoid,
                                                             element - model.triangle_count);
  __builtin_prefetch(e);
  __builtin_prefetch(&e->density_per_m);
}

// Up to kRun candidates, with triangles apart from ellipsoids.
constexpr size_t kRun = 256;
struct CandidatesByKind {
  uint32_t triangle[kRun + 1], ellipsoid[kRun + 1];
  uint32_t alone[kRun + 1];  // ellipsoids that are bounded by voxels
  size_t triangles = 0, ellipsoids = 0, alones = 0;
  TrianglePlace of_triangle[kRun];
};

// Sorts candidates by kind, and prefetches their rays and elements. One prefetch is enough for a
// ray and its answer, because neighbours share their lines.
inline void split_by_kind(const View& view, const Batch& batch, const Candidate* list, size_t count,
                          CandidatesByKind& out) {
  const ModelView* model = nullptr;
  uint32_t instance = Intersection::kNone;
  size_t triangles = 0, ellipsoids = 0, alones = 0;
  for (size_t i = 0; i < count; ++i) {
    const Candidate& c = list[i];
    if (c.instance != instance) {
      instance = c.instance;
      model = &view.model_views[view.instances[instance].model];
    }
    __builtin_prefetch(batch.rays + c.ray);
    __builtin_prefetch(batch.best + c.ray);
    out.triangle[triangles] = out.ellipsoid[ellipsoids] = out.alone[alones] = uint32_t(i);
    if (c.element < model->triangle_count) {
      const TrianglePlace& t = out.of_triangle[triangles++] = in_mesh(*model, c.element);
      __builtin_prefetch(t.hit);
    } else {
      prefetch_ellipsoid(*model, c.element);
      ellipsoids += !model->voxels;
      alones += model->voxels;
    }
  }
  for (size_t k = 0; k < triangles; ++k) {
    for (const float* corner : out.of_triangle[k].corner) __builtin_prefetch(corner);
  }
  out.triangles = triangles;
  out.ellipsoids = ellipsoids;
  out.alones = alones;
}

}  // namespace
}  // namespace underbrush::trace
