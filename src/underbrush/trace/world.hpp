/// \file
/// This file declares `World`, the interface for firing rays at a model or a scene.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/elements/scene.hpp"
#include "underbrush/trace/candidate.hpp"
#include "underbrush/trace/element_math.hpp"
#include "underbrush/trace/unknown_space.hpp"

namespace underbrush::trace {

/// The instruction sets of the kernels. `kBest` is the best one that the machine has.
enum class Isa { kBest, kBase, kAvx2, kAvx512 };

/// Lists of the elements that each of several rays meets.
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

/// The way in which beams draw their trials. With `kOnce` the matter of the world is drawn once, in
/// cells of its grain (`elements::Model::grain`): beams of the same key that pass an element in the
/// same cell have the same trial. With `kAnew` every key draws anew, as if there were no grain.
/// With `kSwaying` the matter of ellipsoids moves with the time: the lower half of a key is the
/// draw, and the upper one the time in ticks (`swaying_cell`).
enum class Draws { kAnew, kOnce, kSwaying };

/// All elements of a model or a scene behind one query interface.
///
/// Rays are in world coordinates, and ranges are in metres along the unit direction. Every answer
/// is that of `intersect` applied to each element, whatever the instruction set and however the
/// rays are divided into calls. Calls with thousands of rays are the fastest, because rays that
/// point alike are traced together.
///
/// The model or scene must outlive the world, and its geometry and hit probabilities must not
/// change in that time. Any number of threads may run queries at once; each query runs on the
/// thread that calls it.
class World {
 public:
  explicit World(const elements::Model& model, Isa isa = Isa::kBest, Draws draws = Draws::kAnew);
  explicit World(const elements::Scene& scene, Isa isa = Isa::kBest, Draws draws = Draws::kAnew);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  /// The model of an instance. Where the world is one model, it is that of instance 0.
  const elements::Model& model(uint32_t instance = 0) const;
  /// Whether the world is one model in its own place, and no scene of several.
  bool is_one_model() const;
  /// The matter that rays may meet in the space that no beam of the log of the first instance's
  /// model crossed; null where that space counts as empty, and where the instance is turned or
  /// scaled. Queries for elements leave it out.
  const UnknownSpace* unknown_space() const;
  /// The elements `met` that a ray meets, in order of range, together with the matter that it may
  /// meet in unknown space (`UnknownSpace::add_to`), in `merged` if there is any.
  std::span<const Intersection> with_unknown(const Ray& ray, const RangeLimits& limits,
                                             std::span<const Intersection> met,
                                             std::vector<Intersection>& merged) const;
  /// The number of an instance for random draws: its own, or where the world is a part of a scene,
  /// that in the whole.
  uint32_t number(uint32_t instance) const;
  /// The place of an instance in the world.
  const elements::Instance& instance(uint32_t instance) const;

  /// Finds the element at which each beam ends, or none() if there is none. It is the nearest
  /// element that the beam meets and whose trial `accept_bits(instance_key(key, instance) ^ cell,
  /// element) < p·2³²` succeeds, where `cell` is that of the grain. Over random keys, this is the
  /// distribution of trials in order of range: P(k) = p_k ∏_{j<k} (1 − p_j). `met[i]` is the answer
  /// for `rays[i]` with `keys[i]`.
  void nearest_accepted(std::span<const Ray> rays, std::span<const uint64_t> keys,
                        const RangeLimits& limits, std::span<Intersection> met) const;
  Intersection nearest_accepted(const Ray& ray, uint64_t key, const RangeLimits& limits) const;

  /// Finds the nearest triangle on each ray, whatever its hit probability, or none().
  void nearest_surface(std::span<const Ray> rays, const RangeLimits& limits,
                       std::span<Intersection> met) const;
  Intersection nearest_surface(const Ray& ray, const RangeLimits& limits) const;

  /// Finds all elements that each ray meets within `limits`. kByRange sorts them as
  /// `Intersection::before` does; kAny leaves them in an order that depends on the machine.
  /// Elements whose bounds a ray enters only beyond its `entry_limits_m` (m) may be left out.
  enum class Sequence { kByRange, kAny };
  void all_intersections(std::span<const Ray> rays, const RangeLimits& limits,
                         std::span<const double> entry_limits_m, IntersectionLists& met,
                         Sequence sequence = Sequence::kByRange) const;
  void all_intersections(const Ray& ray, const RangeLimits& limits, double entry_limit_m,
                         std::vector<Intersection>& met) const;

  /// Finds the pairs of a ray and an element that `all_intersections` has, in no order, with a few
  /// more that are too close for single precision. The spans are valid until the thread's next
  /// search of any world.
  Candidates candidates(std::span<const Ray> rays, const RangeLimits& limits,
                        std::span<const double> entry_limits_m) const;
  /// Decides candidates: `met[k]` is the meeting of the ray and element of `pairs[k]`, or none().
  void intersections(std::span<const Ray> rays, const RangeLimits& limits,
                     std::span<const Candidate> pairs, std::span<Intersection> met) const;

  /// The way in which the trials are drawn.
  Draws draws() const;
  /// Takes over the sides of the cells in the models' grain, which may have changed; the classes in
  /// it must be the same as before. No query may run meanwhile.
  void update_grain();
  /// The memory of the search structure without models and instances, bytes.
  size_t bytes() const;
  /// The name of the instruction set in use.
  std::string_view isa() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace underbrush::trace
