/// \file
/// A world that beams can be fired into.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/elements/scene.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

/// Instruction sets of the kernels. `kBest` takes the best that the machine has.
enum class Isa { kBest, kBase, kAvx2, kAvx512 };

/// What each of several rays meets, in order of range.
class IntersectionLists {
 public:
  size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  std::span<const Intersection> operator[](size_t ray) const {
    return {met_.data() + first_[ray], first_[ray + 1] - first_[ray]};
  }

 private:
  friend class World;
  std::vector<size_t> first_;
  std::vector<Intersection> met_;
};

/// All elements of a model or a scene behind one query interface. Model or scene must outlive the
/// world, and geometry and hit probabilities must not change meanwhile. Queries may run on any
/// number of threads at once; each uses the thread that asks. Rays are in world coordinates; ranges
/// are in metres along the unit direction. Every answer is that of `intersect`, element by element,
/// whatever the instruction set and however the rays are cut into calls; the more rays a call
/// brings, the faster (thousands: rays that point alike are traced together).
class World {
 public:
  explicit World(const elements::Model& model, Isa isa = Isa::kBest);
  explicit World(const elements::Scene& scene, Isa isa = Isa::kBest);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  /// The model of an instance; of instance 0 where the world is one model.
  const elements::Model& model(uint32_t instance = 0) const;
  /// Where that model stands.
  const elements::Instance& instance(uint32_t instance) const;

  /// The element at which a beam ends: the nearest that it meets and whose trial
  /// `accept_bits(instance_key(key, instance), element) < p·2³²` succeeds; none if there is no such
  /// element. Distributed as trials in order of range: P(k) = p_k ∏_{j<k} (1 − p_j). `met[i]` is
  /// the answer for `rays[i]` with `keys[i]`.
  void nearest_accepted(std::span<const Ray> rays, std::span<const uint64_t> keys,
                        const RangeLimits& limits, std::span<Intersection> met) const;
  Intersection nearest_accepted(const Ray& ray, uint64_t key, const RangeLimits& limits) const;

  /// The nearest triangle, whatever its hit probability.
  void nearest_surface(std::span<const Ray> rays, const RangeLimits& limits,
                       std::span<Intersection> met) const;
  Intersection nearest_surface(const Ray& ray, const RangeLimits& limits) const;

  /// All elements that each ray meets within `limits`, in the order of `Intersection::before` or in
  /// one that depends on the machine. Those whose bounds a ray enters only beyond its
  /// `entry_limits_m` may be left out.
  enum class Sequence { kByRange, kAny };
  void all_intersections(std::span<const Ray> rays, const RangeLimits& limits,
                         std::span<const double> entry_limits_m, IntersectionLists& met,
                         Sequence sequence = Sequence::kByRange) const;
  void all_intersections(const Ray& ray, const RangeLimits& limits, double entry_limit_m,
                         std::vector<Intersection>& met) const;

  /// Bytes of the search structure (models and instances not counted).
  size_t bytes() const;
  /// Name of the instruction set in use.
  std::string_view isa() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace underbrush::trace
