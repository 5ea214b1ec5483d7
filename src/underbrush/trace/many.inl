// Included by kernel.inl: `meet` for many rays and elements, as many of a kind at a time as a
// vector of doubles holds. Answers go
// to out[i], one a candidate, or if there is no `out` to the best of each candidate's ray.
namespace underbrush::trace {
namespace {

#if defined(__AVX512F__)
constexpr int kMany = 8;
#elif defined(__AVX2__)
constexpr int kMany = 4;
#else
constexpr int kMany = 2;
#endif
typedef double D __attribute__((vector_size(8 * kMany)));
typedef int64_t L __attribute__((vector_size(8 * kMany)));

inline D absolute(D a) { return (D)((L)a & 0x7fffffffffffffff); }
#if defined(__AVX512F__)
inline D square_root(D a) { return _mm512_sqrt_pd(a); }
inline unsigned bits(L mask) { return _mm512_movepi64_mask((__m512i)mask); }
#elif defined(__AVX2__)
inline D square_root(D a) { return _mm256_sqrt_pd(a); }
inline unsigned bits(L mask) { return unsigned(_mm256_movemask_pd((__m256d)mask)); }
#else
inline D square_root(D a) { return _mm_sqrt_pd(a); }
inline unsigned bits(L mask) { return unsigned(_mm_movemask_pd((__m128d)mask)); }
#endif

// Up to kMany candidates of one kind that wait to be decided, in columns.
struct Pending {
  D o[3], d[3], p, sigma, scale;
  D mean[3], covariance[6], tau2;  // ellipsoids
  D corner[3][3];                  // triangles; as o and d, in the order of the sheared frame
  size_t index[kMany];
  int count = 0;
};

inline void clear(Met& met) {
  met.t_m = met.sigma_m = met.delta2 = met.p = 0;
  met.element = Met::kNone;
  met.instance = 0;
}

inline void write(const Pending& w, const Batch& batch, const Candidate* list, unsigned inside, D t,
                  D sigma, D delta2, Met* out) {
  const D range = t * w.scale, spread = sigma * w.scale;
  const D zero{};
  inside &= bits((range >= zero + batch.limits.min_m) & (range <= zero + batch.limits.max_m));
  for (int k = 0; k < w.count; ++k) {
    const Candidate& c = list[w.index[k]];
    Met& met = out ? out[w.index[k]] : batch.best[c.ray];
    met.t_m = range[k];
    met.sigma_m = spread[k];
    met.delta2 = delta2[k];
    met.p = w.p[k];
    met.element = c.element;
    met.instance = c.instance;
    if (!(inside >> k & 1)) clear(met);
  }
}

inline void decide_ellipsoids(Pending& w, const Batch& batch, const Candidate* list, Met* out) {
  const Approach<D> a = approach_of(w.o, w.d, w.mean, w.covariance);
  write(w, batch, list, bits(a.delta2 <= w.tau2), a.t, square_root(a.sigma2), a.delta2, out);
  w.count = 0;
}

inline void decide_triangles(const View& view, Pending& w, const Batch& batch,
                             const Candidate* list, Met* out) {
  const Sheared<D> s = shear(w.o, w.d, w.corner);
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
  write(w, batch, list, bits(above | below), range_at(s, weight, w.d[2]), w.sigma, zero, out);
  for (int k = 0; k < w.count && certain != (1u << kMany) - 1; ++k) {
    // On an edge, as far as plain arithmetic goes.
    if (certain >> k & 1) continue;
    const Candidate& c = list[w.index[k]];
    (out ? out[w.index[k]] : batch.best[c.ray]) = meet_placed(view, batch, c);
  }
  w.count = 0;
}

inline void add_ellipsoid(Pending& w, const elements::Ellipsoid& e, double tau2, const double o[3],
                          const double d[3]) {
  const int k = w.count;
  const float* mean = reinterpret_cast<const float*>(&e.mean);
  const float* covariance = reinterpret_cast<const float*>(&e.covariance);
  for (int a = 0; a < 3; ++a) {
    w.o[a][k] = o[a];
    w.d[a][k] = d[a];
    w.mean[a][k] = double(mean[a]);
  }
  for (int c = 0; c < 6; ++c) w.covariance[c][k] = double(covariance[c]);
  w.tau2[k] = tau2;
  w.p[k] = double(e.hit.p);
}

inline void add_triangle(Pending& w, const ModelView::Mesh& mesh, uint32_t at, const double o[3],
                         const double d[3]) {
  const int k = w.count;
  const double size[3] = {__builtin_fabs(d[0]), __builtin_fabs(d[1]), __builtin_fabs(d[2])};
  int z = 0;
  if (size[1] > size[z]) z = 1;
  if (size[2] > size[z]) z = 2;
  const int axis[3] = {z == 2 ? 0 : z + 1, z == 0 ? 2 : z - 1, z};
  for (int a = 0; a < 3; ++a) {
    w.o[a][k] = o[axis[a]];
    w.d[a][k] = d[axis[a]];
  }
  for (int v = 0; v < 3; ++v) {
    const float* corner = mesh.vertices + 3 * size_t(mesh.triangles[3 * size_t(at) + size_t(v)]);
    for (int a = 0; a < 3; ++a) w.corner[v][a][k] = double(corner[axis[a]]);
  }
  w.p[k] = double(mesh.hit[at].p);
  w.sigma[k] = mesh.sigma_m;
}

// Triangle `at` of a mesh of the model.
struct InMesh {
  const ModelView::Mesh& mesh;
  uint32_t at;
};
inline InMesh in_mesh(const ModelView& m, uint32_t element) {
  if (element < m.ground_count) return {m.ground, element};
  return {m.surface, element - m.ground_count};
}

inline const ModelView& model_of(const View& view, const Candidate& c) {
  return view.model_views[view.instances[c.instance].model];
}

// Up to kRun candidates, triangles apart from ellipsoids; calls the memory of their elements.
constexpr size_t kRun = 256;
struct Sorted {
  uint32_t triangle[kRun + 1], ellipsoid[kRun + 1];
  size_t triangles = 0, ellipsoids = 0;
};

inline void sort_out(const View& view, const Candidate* list, size_t count, Sorted& out) {
  for (size_t i = 0; i < count; ++i) {
    const ModelView& m = model_of(view, list[i]);
    const bool is_triangle = list[i].element < m.triangle_count;
    out.triangle[out.triangles] = out.ellipsoid[out.ellipsoids] = uint32_t(i);
    out.triangles += is_triangle;
    out.ellipsoids += !is_triangle;
  }
  for (size_t k = 0; k < out.ellipsoids; ++k) {
    const Candidate& c = list[out.ellipsoid[k]];
    const ModelView& m = model_of(view, c);
    const char* e = reinterpret_cast<const char*>(&m.ellipsoids[c.element - m.triangle_count]);
    __builtin_prefetch(e);
    __builtin_prefetch(e + sizeof(elements::Ellipsoid) - 1);
  }
  for (size_t k = 0; k < out.triangles; ++k) {
    const Candidate& c = list[out.triangle[k]];
    const InMesh t = in_mesh(model_of(view, c), c.element);
    __builtin_prefetch(t.mesh.triangles + 3 * size_t(t.at));
    __builtin_prefetch(t.mesh.hit + t.at);
  }
}

// The candidate's ray in its model.
inline void stand(const View& view, const Batch& batch, const Candidate& c, Stand& at,
                  uint32_t& at_instance, double o[3], double d[3]) {
  if (c.instance != at_instance) {
    at = stand_of(view, c.instance);
    at_instance = c.instance;
  }
  if (!at.is_translation) return place_ray(view, batch, c, o, d);
  const Ray& ray = batch.rays[c.ray];
  for (int a = 0; a < 3; ++a) {
    o[a] = ray.origin.data()[a] - at.translation[a];
    d[a] = ray.direction.data()[a];
  }
}

void meet_run(const View& view, const Batch& batch, const Candidate* list, size_t count, Met* out) {
  Sorted sorted;
  sort_out(view, list, count, sorted);
  uint32_t at_instance = Met::kNone;
  Stand at;
  double o[3], d[3];
  Pending w;
  for (size_t k = 0; k < sorted.ellipsoids; ++k) {
    const uint32_t i = sorted.ellipsoid[k];
    const Candidate& c = list[i];
    stand(view, batch, c, at, at_instance, o, d);
    const ModelView& m = *at.model;
    const elements::Ellipsoid& e = m.ellipsoids[c.element - m.triangle_count];
    if (m.voxels || e.density_per_m > 0) {
      (out ? out[i] : batch.best[c.ray]) = meet_placed(view, batch, c);
      continue;
    }
    add_ellipsoid(w, e, m.tau2, o, d);
    w.scale[w.count] = at.scale;
    w.index[w.count++] = i;
    if (w.count == kMany) decide_ellipsoids(w, batch, list, out);
  }
  if (w.count > 0) decide_ellipsoids(w, batch, list, out);
  for (size_t k = 0; k < sorted.triangles; ++k) {
    const Candidate& c = list[sorted.triangle[k]];
    const InMesh t = in_mesh(model_of(view, c), c.element);
    for (size_t v = 0; v < 3; ++v) {
      __builtin_prefetch(t.mesh.vertices + 3 * size_t(t.mesh.triangles[3 * size_t(t.at) + v]));
    }
  }
  for (size_t k = 0; k < sorted.triangles; ++k) {
    const uint32_t i = sorted.triangle[k];
    const Candidate& c = list[i];
    stand(view, batch, c, at, at_instance, o, d);
    const InMesh t = in_mesh(*at.model, c.element);
    add_triangle(w, t.mesh, t.at, o, d);
    w.scale[w.count] = at.scale;
    w.index[w.count++] = i;
    if (w.count == kMany) decide_triangles(view, w, batch, list, out);
  }
  if (w.count > 0) decide_triangles(view, w, batch, list, out);
}

void meet_many(const View& view, const Batch& batch, const Candidate* list, size_t count,
               Met* out) {
  for (size_t from = 0; from < count; from += kRun) {
    meet_run(view, batch, list + from, count - from < kRun ? count - from : kRun,
             out ? out + from : nullptr);
  }
}

}  // namespace
}  // namespace underbrush::trace
