#include "underbrush/trace/world.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/trace/kernel.hpp"

namespace underbrush::trace {
namespace {

const Kernels& kernels_of(Isa isa) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  require(isa != Isa::kAvx2 || avx2, "this machine has no AVX2");
  require(isa != Isa::kAvx512 || avx512, "this machine has no AVX-512");
  if (isa == Isa::kAvx512 || (isa == Isa::kBest && avx512)) return kKernelsAvx512;
  if (isa == Isa::kAvx2 || (isa == Isa::kBest && avx2)) return kKernelsAvx2;
#endif
  return kKernelsBase;
}

ModelView::Mesh view_of(const elements::TriangleMesh& mesh) {
  return {mesh.vertices.empty() ? nullptr : mesh.vertices[0].data(),
          mesh.triangles.empty() ? nullptr : mesh.triangles[0].data(),
          mesh.hit.data(),
          mesh.range_sigma_m,
          mesh.roughness_m,
          mesh.roughness.empty() ? nullptr : mesh.roughness.data()};
}

void set_grain(const elements::Model& m, Draws draws, ModelView& view) {
  const auto cells_per_m = [&](double side_m) { return draws == Draws::kAnew ? 0 : 1 / side_m; };
  view.cells_per_m.triangles = cells_per_m(m.grain.mesh_m);
  view.cells_per_m.kinds = int(m.grain.classes.size()) + 1;
  for (size_t k = 0; k <= m.grain.classes.size(); ++k) {
    view.cells_per_m.ellipsoids[k] = cells_per_m(m.grain.side_at(k));
  }
  view.sways = draws == Draws::kSwaying;
}

ModelView::Numbers numbers_of(const elements::Model& m, elements::Kind kind) {
  if (!m.part_of) return {nullptr, 0};
  const std::vector<uint32_t>& all = m.part_of->numbers[size_t(kind)];
  return {all.data(), uint32_t(all.size())};
}

ModelView view_of(const elements::Model& m) {
  return {view_of(m.ground),
          view_of(m.surface),
          m.ellipsoids.data(),
          uint32_t(m.whole_count(elements::Kind::kGround)),
          uint32_t(m.first_ellipsoid()),
          m.tau * m.tau,
          m.voxel_m > 0,
          {},
          false,
          m.leaf_angles.level(),
          m.leaf_angles.slope(),
          {numbers_of(m, elements::Kind::kGround), numbers_of(m, elements::Kind::kSurface),
           numbers_of(m, elements::Kind::kEllipsoid)}};
}

/// The working memory of a thread's queries. It is large, and is kept from call to call.
struct Workspace {
  Batch batch;
  FloatRays float_rays;
  DirectionOrder order;
  Known ellipsoids, triangles;
  std::vector<Intersection> mets;
};

Workspace& workspace() {
  thread_local Workspace w;
  return w;
}

}  // namespace

struct World::Impl {
  std::vector<const elements::Model*> models;
  std::span<const elements::Instance> instances;
  const uint32_t* numbers = nullptr;
  elements::Instance alone;  // the only instance of a world that is one model
  std::vector<ModelView> views;
  std::vector<Bvh> bvhs;
  SceneTree tree;
  const Kernels* kernels;
  Draws draws = Draws::kAnew;
  std::optional<UnknownSpace> unknown;

  void build(Draws chosen) {
    draws = chosen;
    std::vector<bool> placed(models.size());
    for (const elements::Instance& i : instances) placed[i.model] = true;
    for (size_t k = 0; k < models.size(); ++k) {
      const elements::Model* m = models[k];
      require(m->first_ellipsoid() + m->whole_count(elements::Kind::kEllipsoid) < kElementMask,
              "world: a model has more than 2^29 elements");
      views.push_back(view_of(*m));
      bvhs.push_back(placed[k] ? build_bvh(*m) : Bvh{});  // No ray comes to what stands nowhere.
      require(bvhs.back().triangles.size() < kMostTriangleBlocks,
              "world: a model has too many triangles");
    }
    update_grain();
    tree = build_scene_tree(instances, bvhs);
    require(tree.entries.size() < kIndexMask, "world: too many instances");
  }

  /// Takes over the unknown space of the first instance.
  void find_unknown() {
    if (instances.empty()) return;
    const elements::Instance& first = instances[0];
    const elements::Model& m = *models[first.model];
    if (!m.observed || !is_translation(first) || first.scale != 1) return;
    const bool is_part = m.part_of && m.part_of->ground;
    unknown.emplace(*m.observed, is_part ? *m.part_of->ground : m.ground,
                    first.world_from_model.translation);
  }

  void update_grain() {
    for (size_t k = 0; k < models.size(); ++k) set_grain(*models[k], draws, views[k]);
  }

  View view() const {
    return {tree.nodes.data(), tree.entries.data(),
            tree.root,         {tree.origin[0], tree.origin[1], tree.origin[2]},
            instances.data(),  numbers,
            models.data(),     views.data(),
            bvhs.data()};
  }

  /// Traces `count` rays of the batch.
  void trace(Query query, Workspace& w, size_t count) const {
    const View v = view();
    Batch& batch = w.batch;
    if (tree.root == kEmpty) {
      if (batch.best) std::fill_n(batch.best, count, Intersection{});
      return;
    }
    for (batch.first = 0; batch.first < count; batch.first += kBatchRays) {
      const size_t n = std::min(kBatchRays, count - batch.first);
      batch.float_rays = &w.float_rays;
      batch.ellipsoids = &w.ellipsoids;
      batch.triangles = &w.triangles;
      w.ellipsoids.count = w.triangles.count = 0;
      const uint64_t* keys = batch.keys ? batch.keys + batch.first : nullptr;
      if (n > 1) kernels->convert_rays(v, batch.rays + batch.first, keys, n, w.float_rays);
      kernels->trace(v, query, batch, w.order.of(w.float_rays, n), n);
      kernels->answer_known(v, batch);
    }
  }

  void nearest(Query query, std::span<const Ray> rays, std::span<const uint64_t> keys,
               const RangeLimits& limits, std::span<Intersection> met) const {
    Workspace& w = workspace();
    w.batch.rays = rays.data();
    w.batch.keys = keys.data();
    w.batch.limits = limits;
    w.batch.best = met.data();
    trace(query, w, rays.size());
  }
};

World::World(const elements::Model& model, Isa isa, Draws draws) : impl_(std::make_unique<Impl>()) {
  impl_->kernels = &kernels_of(isa);
  impl_->models = {&model};
  impl_->alone.world_from_model.translation = model.origin;
  impl_->instances = {&impl_->alone, 1};
  impl_->build(draws);
  impl_->find_unknown();
}

World::World(const elements::Scene& scene, Isa isa, Draws draws) : impl_(std::make_unique<Impl>()) {
  scene.check();
  impl_->kernels = &kernels_of(isa);
  for (const elements::Model& m : scene.models) impl_->models.push_back(&m);
  impl_->instances = scene.instances;
  if (!scene.numbers.empty()) impl_->numbers = scene.numbers.data();
  impl_->build(draws);
  impl_->find_unknown();
}

World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

const elements::Model& World::model(uint32_t instance) const {
  return *impl_->models[this->instance(instance).model];
}

bool World::is_one_model() const { return impl_->instances.data() == &impl_->alone; }

const UnknownSpace* World::unknown_space() const {
  return impl_->unknown ? &*impl_->unknown : nullptr;
}

std::span<const Intersection> World::with_unknown(const Ray& ray, const RangeLimits& limits,
                                                  std::span<const Intersection> met,
                                                  std::vector<Intersection>& merged) const {
  if (!impl_->unknown) return met;
  impl_->unknown->add_to(ray, limits, met, merged);
  return merged;
}

uint32_t World::number(uint32_t instance) const {
  return impl_->numbers ? impl_->numbers[instance] : instance;
}

const elements::Instance& World::instance(uint32_t instance) const {
  require(instance < impl_->instances.size(), "world: no such instance");
  return impl_->instances[instance];
}

void World::nearest_accepted(std::span<const Ray> rays, std::span<const uint64_t> keys,
                             const RangeLimits& limits, std::span<Intersection> met) const {
  require(keys.size() == rays.size() && met.size() == rays.size(),
          "rays, keys and answers differ in number");
  impl_->nearest(Query::kAccepted, rays, keys, limits, met);
}

void World::nearest_surface(std::span<const Ray> rays, const RangeLimits& limits,
                            std::span<Intersection> met) const {
  require(met.size() == rays.size(), "rays and answers differ in number");
  impl_->nearest(Query::kSurface, rays, {}, limits, met);
}

Intersection World::nearest_accepted(const Ray& ray, uint64_t key,
                                     const RangeLimits& limits) const {
  Intersection met;
  nearest_accepted({&ray, 1}, {&key, 1}, limits, {&met, 1});
  return met;
}

Intersection World::nearest_surface(const Ray& ray, const RangeLimits& limits) const {
  Intersection met;
  nearest_surface({&ray, 1}, limits, {&met, 1});
  return met;
}

Candidates World::candidates(std::span<const Ray> rays, const RangeLimits& limits,
                             std::span<const double> entry_limits_m) const {
  require(entry_limits_m.size() == rays.size(), "rays and limits differ in number");
  Workspace& w = workspace();
  Batch& batch = w.batch;
  batch.rays = rays.data();
  batch.keys = nullptr;
  batch.best = nullptr;
  batch.limits = limits;
  batch.entry_limits_m = entry_limits_m.data();
  batch.candidates.clear();
  batch.bounds.clear();
  impl_->trace(Query::kAll, w, rays.size());
  return {batch.candidates, batch.bounds};
}

void World::intersections(std::span<const Ray> rays, const RangeLimits& limits,
                          std::span<const Candidate> pairs, std::span<Intersection> met) const {
  require(pairs.size() == met.size(), "candidates and answers differ in number");
  Batch batch{};
  batch.rays = rays.data();
  batch.limits = limits;
  impl_->kernels->intersect_many(impl_->view(), batch, pairs.data(), pairs.size(), met.data());
}

void World::all_intersections(std::span<const Ray> rays, const RangeLimits& limits,
                              std::span<const double> entry_limits_m, IntersectionLists& lists,
                              Sequence sequence) const {
  const std::span<const Candidate> pairs = candidates(rays, limits, entry_limits_m).pairs;
  Workspace& w = workspace();
  w.mets.resize(pairs.size());
  intersections(rays, limits, pairs, w.mets);
  lists.first_.assign(rays.size() + 1, 0);
  for (size_t k = 0; k < w.mets.size(); ++k) {
    if (!w.mets[k].none()) ++lists.first_[pairs[k].ray + 1];
  }
  for (size_t i = 0; i < rays.size(); ++i) lists.first_[i + 1] += lists.first_[i];
  lists.met_.resize(lists.first_.back());
  std::vector<size_t> next(lists.first_.begin(), lists.first_.end() - 1);
  for (size_t k = 0; k < w.mets.size(); ++k) {
    if (!w.mets[k].none()) lists.met_[next[pairs[k].ray]++] = w.mets[k];
  }
  for (size_t i = 0; sequence == Sequence::kByRange && i < rays.size(); ++i) {
    std::sort(lists.met_.begin() + long(lists.first_[i]),
              lists.met_.begin() + long(lists.first_[i + 1]),
              [](const Intersection& a, const Intersection& b) { return a.before(b); });
  }
}

void World::all_intersections(const Ray& ray, const RangeLimits& limits, double entry_limit_m,
                              std::vector<Intersection>& met) const {
  IntersectionLists lists;
  all_intersections({&ray, 1}, limits, {&entry_limit_m, 1}, lists);
  met.assign(lists[0].begin(), lists[0].end());
}

Draws World::draws() const { return impl_->draws; }

void World::update_grain() { impl_->update_grain(); }

size_t World::bytes() const {
  size_t bytes = impl_->tree.bytes();
  for (const Bvh& b : impl_->bvhs) bytes += b.bytes();
  return bytes;
}

std::string_view World::isa() const { return impl_->kernels->name; }

}  // namespace underbrush::trace
