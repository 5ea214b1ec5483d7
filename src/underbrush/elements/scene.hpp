/// \file
/// A world composed of models. Each model is stored once and can be placed many times.
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::elements {

/// A placed model: x_world = translation + scale · R x, with x relative to the model's origin.
struct Instance {
  Pose world_from_model;
  float scale = 1;
  uint32_t model = 0;  ///< Index into the models of the scene.
};

/// The motion of an instance. `world_from_object` takes the place of the instance's own pose;
/// before its first pose and after its last the instance stands still. Beams before `from_s` and
/// from `to_s` on do not meet it.
struct Mover {
  uint32_t instance = 0;
  Trajectory world_from_object;
  double from_s = -std::numeric_limits<double>::infinity();  ///< s.
  double to_s = std::numeric_limits<double>::infinity();     ///< s.

  /// Whether a beam of this time (s) may meet the instance.
  bool is_there(double time_s) const { return time_s >= from_s && time_s < to_s; }
};

/// Models and their placements. The ground is a model like any other.
struct Scene {
  std::vector<Model> models;
  std::vector<Instance> instances;
  /// The numbers of the instances in the whole scene of which this is a part, ascending; random
  /// numbers are drawn by them. Empty where the scene is whole.
  std::vector<uint32_t> numbers;

  /// The number of an instance in the whole scene.
  uint32_t number(uint32_t instance) const {
    return numbers.empty() ? instance : numbers[instance];
  }
  /// Throws `std::invalid_argument` where a model is inconsistent, an instance names no model, a
  /// pose or scale is not finite, or a scale is not positive.
  void check() const;
};

/// The correlation time of the matter of a world of these models (s): the shortest of those that
/// have ellipsoids; 0 where the matter of any of these stands still.
double sway_of(std::span<const Model> models);

}  // namespace underbrush::elements
