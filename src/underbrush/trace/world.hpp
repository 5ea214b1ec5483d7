/// \file
/// A world that beams can be fired into.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/trace/bvh.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

/// Instruction sets of the kernels. `kBest` takes the best that the machine has.
enum class Isa { kBest, kBase, kAvx2, kAvx512 };

/// All elements of a model behind one query interface. The model must outlive the world, and its
/// geometry and hit probabilities must not change meanwhile. Queries may run on any number of
/// threads at once. Rays are in world coordinates; ranges are in metres along the unit direction.
class World {
 public:
  explicit World(const elements::Model& model, Isa isa = Isa::kBest);

  const elements::Model& model() const { return model_; }

  /// The element at which a beam ends: the nearest that it meets and whose trial
  /// `accept_bits(key, element) < p·2³²` succeeds; none if there is no such element. Distributed as
  /// trials in order of range: P(k) = p_k ∏_{j<k} (1 − p_j).
  Met nearest_accepted(const Ray& ray, uint64_t key, const RangeLimits& limits) const;

  /// The nearest triangle, whatever its hit probability.
  Met nearest_surface(const Ray& ray, const RangeLimits& limits) const;

  /// Replaces `met` with all elements that the ray meets within `limits`, in order of range, ties
  /// by number. Those whose bounds the ray enters only beyond `entry_limit_m` may be left out.
  void all_met(const Ray& ray, const RangeLimits& limits, double entry_limit_m,
               std::vector<Met>& met) const;

  /// Bytes of the search structure (the model not counted).
  size_t bytes() const { return bvh_.bytes(); }
  /// Name of the instruction set in use.
  std::string_view isa() const;

 private:
  const elements::Model& model_;
  Bvh bvh_;
  const struct Kernels* kernels_;
};

}  // namespace underbrush::trace
