#include "underbrush/trace/world.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/trace/kernel.hpp"

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

Query query_of(const elements::Model& model, const Ray& ray, const RangeLimits& limits) {
  Query q;
  q.origin = ray.origin - model.origin;
  q.direction = ray.direction;
  q.limits = limits;
  return q;
}

}  // namespace

World::World(const elements::Model& model, Isa isa)
    : model_(model), bvh_(build_bvh(model)), kernels_(&kernels_of(isa)) {
  require(model.size() < kIndexMask, "world: more than 2^30 elements");
}

static View view_of(const elements::Model& model, const Bvh& bvh) {
  return {&model, bvh.nodes.data(), bvh.ellipsoids.data(), bvh.triangles.data(), bvh.root};
}

Met World::nearest_accepted(const Ray& ray, uint64_t key, const RangeLimits& limits) const {
  Query q = query_of(model_, ray, limits);
  q.key = key;
  Met best;
  kernels_->nearest_accepted(view_of(model_, bvh_), q, best);
  return best;
}

Met World::nearest_surface(const Ray& ray, const RangeLimits& limits) const {
  Met best;
  kernels_->nearest_triangle(view_of(model_, bvh_), query_of(model_, ray, limits), best);
  return best;
}

void World::all_met(const Ray& ray, const RangeLimits& limits, double entry_limit_m,
                    std::vector<Met>& met) const {
  met.clear();
  kernels_->all_met(view_of(model_, bvh_), query_of(model_, ray, limits), entry_limit_m, met);
  std::sort(met.begin(), met.end(), [](const Met& a, const Met& b) { return a.before(b); });
}

std::string_view World::isa() const { return kernels_->name; }

}  // namespace underbrush::trace
