#include "underbrush/trace/world.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/order.hpp"

namespace underbrush::trace {
namespace {

const Kernels& kernels_of(Isa isa) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  require(isa != Isa::kAvx2 || avx2, "this machine has no AVX2");
  require(isa != Isa::kAvx512 || avx512, "this machine has no AVX-512");
  if (isa == Isa::kAvx512 || (isa == Isa::kBest && avx512)) return kKernelsAvx512;
  if (isa == Isa::kAvx2 || (isa == Isa::kBest && avx2)) return kKernelsAvx2;
#endif
  return kKernelsBase;
}

/// The batch of a thread: it is large, and its parts keep their memory from call to call.
Batch& own_batch() {
  thread_local Batch batch;
  return batch;
}

/// Calls `packet(numbers)` for up to kPacket rays at a time, by their numbers in `rays`.
template <class Packet>
void for_packets(std::span<const Ray> rays, Packet packet) {
  thread_local std::vector<uint32_t> order(kOrdered), scratch(kOrdered);
  uint32_t numbers[kPacket];
  for (size_t begin = 0; begin < rays.size(); begin += kOrdered) {
    const size_t n = std::min(kOrdered, rays.size() - begin);
    const std::span<uint32_t> in_order(order.data(), n);
    order_by_direction(rays.subspan(begin, n), in_order, {scratch.data(), n});
    for (size_t at = 0; at < n; at += kPacket) {
      const size_t count = std::min<size_t>(kPacket, n - at);
      for (size_t k = 0; k < count; ++k) numbers[k] = uint32_t(begin) + in_order[at + k];
      packet(std::span<const uint32_t>(numbers, count));
    }
  }
}

}  // namespace

struct World::Impl {
  std::vector<const elements::Model*> models;
  std::span<const elements::Instance> instances;
  elements::Instance alone;  // of a world that is one model
  std::vector<Bvh> bvhs;
  SceneTree tree;
  const Kernels* kernels;

  void build() {
    for (const elements::Model* m : models) {
      require(m->size() < kIndexMask, "world: a model has more than 2^29 elements");
      bvhs.push_back(build_bvh(*m));
    }
    tree = build_scene_tree(instances, bvhs);
    require(tree.entries.size() < kIndexMask, "world: too many instances");
  }

  View view() const {
    return {tree.nodes.data(), tree.entries.data(), tree.root,
            {tree.origin[0], tree.origin[1], tree.origin[2]},
            instances.data(), models.data(), bvhs.data()};
  }

  void trace(Ask ask, Batch& batch, int count) const {
    if (tree.root == kEmpty) return;
    const View v = view();
    if (count > kPacket / 16 && kernels->packet(v, ask, batch)) return;
    for (int i = 0; i < count; ++i) kernels->one(v, ask, batch, i);
  }

  void nearest(Ask ask, std::span<const Ray> rays, std::span<const uint64_t> keys,
               const RangeLimits& limits, std::span<Met> met) const {
    Batch& batch = own_batch();
    batch.limits = limits;
    for_packets(rays, [&](std::span<const uint32_t> number) {
      for (size_t k = 0; k < kPacket; ++k) {
        const uint32_t i = number[std::min(k, number.size() - 1)];
        batch.ray[k] = &rays[i];
        batch.key[k] = keys.empty() ? 0 : keys[i];
        batch.best[k] = {};
      }
      trace(ask, batch, int(number.size()));
      for (size_t k = 0; k < number.size(); ++k) met[number[k]] = batch.best[k];
    });
  }
};

World::World(const elements::Model& model, Isa isa) : impl_(std::make_unique<Impl>()) {
  impl_->kernels = &kernels_of(isa);
  impl_->models = {&model};
  impl_->alone.world_from_model.translation = model.origin;
  impl_->instances = {&impl_->alone, 1};
  impl_->build();
}

World::World(const elements::Scene& scene, Isa isa) : impl_(std::make_unique<Impl>()) {
  scene.check();
  impl_->kernels = &kernels_of(isa);
  for (const elements::Model& m : scene.models) impl_->models.push_back(&m);
  impl_->instances = scene.instances;
  impl_->build();
}

World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

const elements::Model& World::model(uint32_t instance) const {
  return *impl_->models[this->instance(instance).model];
}

const elements::Instance& World::instance(uint32_t instance) const {
  require(instance < impl_->instances.size(), "world: no such instance");
  return impl_->instances[instance];
}

void World::nearest_accepted(std::span<const Ray> rays, std::span<const uint64_t> keys,
                             const RangeLimits& limits, std::span<Met> met) const {
  require(keys.size() == rays.size() && met.size() == rays.size(),
          "rays, keys and answers differ in number");
  impl_->nearest(Ask::kAccepted, rays, keys, limits, met);
}

void World::nearest_surface(std::span<const Ray> rays, const RangeLimits& limits,
                            std::span<Met> met) const {
  require(met.size() == rays.size(), "rays and answers differ in number");
  impl_->nearest(Ask::kSurface, rays, {}, limits, met);
}

Met World::nearest_accepted(const Ray& ray, uint64_t key, const RangeLimits& limits) const {
  Met met;
  nearest_accepted({&ray, 1}, {&key, 1}, limits, {&met, 1});
  return met;
}

Met World::nearest_surface(const Ray& ray, const RangeLimits& limits) const {
  Met met;
  nearest_surface({&ray, 1}, limits, {&met, 1});
  return met;
}

void World::all_met(std::span<const Ray> rays, const RangeLimits& limits,
                    std::span<const double> entry_limits_m, MetLists& lists) const {
  require(entry_limits_m.size() == rays.size(), "rays and limits differ in number");
  struct OfRay {
    uint32_t ray;
    Met met;
  };
  thread_local std::vector<OfRay> found;
  found.clear();
  Batch& batch = own_batch();
  batch.limits = limits;
  for_packets(rays, [&](std::span<const uint32_t> number) {
    for (size_t k = 0; k < kPacket; ++k) {
      const uint32_t i = number[std::min(k, number.size() - 1)];
      batch.ray[k] = &rays[i];
      batch.key[k] = 0;
      batch.entry_limit_m[k] = entry_limits_m[i];
    }
    batch.candidates.clear();
    impl_->trace(Ask::kAll, batch, int(number.size()));
    for (const Candidate& c : batch.candidates) {
      if (c.ray >= number.size()) continue;
      const elements::Instance& placed = impl_->instances[c.instance];
      const Met met = meet(*impl_->models[placed.model], placed, c.instance, c.element,
                           *batch.ray[c.ray], limits);
      if (!met.none()) found.push_back({number[c.ray], met});
    }
  });
  // By ray, then by range.
  lists.first_.assign(rays.size() + 1, 0);
  for (const OfRay& f : found) ++lists.first_[f.ray + 1];
  for (size_t i = 0; i < rays.size(); ++i) lists.first_[i + 1] += lists.first_[i];
  lists.met_.resize(found.size());
  thread_local std::vector<size_t> next;
  next.assign(lists.first_.begin(), lists.first_.end() - 1);
  for (const OfRay& f : found) lists.met_[next[f.ray]++] = f.met;
  for (size_t i = 0; i < rays.size(); ++i) {
    std::sort(lists.met_.begin() + long(lists.first_[i]),
              lists.met_.begin() + long(lists.first_[i + 1]),
              [](const Met& a, const Met& b) { return a.before(b); });
  }
}

void World::all_met(const Ray& ray, const RangeLimits& limits, double entry_limit_m,
                    std::vector<Met>& met) const {
  MetLists lists;
  all_met({&ray, 1}, limits, {&entry_limit_m, 1}, lists);
  met.assign(lists[0].begin(), lists[0].end());
}

size_t World::bytes() const {
  size_t bytes = impl_->tree.bytes();
  for (const Bvh& b : impl_->bvhs) bytes += b.bytes();
  return bytes;
}

std::string_view World::isa() const { return impl_->kernels->name; }

}  // namespace underbrush::trace
