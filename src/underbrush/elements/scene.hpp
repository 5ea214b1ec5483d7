/// \file
/// A world composed of models: each stored once, placed as often as wanted.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::elements {

/// A model placed in a scene: x_world = translation + scale · R x, with x relative to the model's
/// origin.
struct Instance {
  Pose world_from_model;
  float scale = 1;
  uint32_t model = 0;  ///< Index into the scene's models.
};

/// An instance of a scene that moves: its pose is that of `world_from_object` (instead of the
/// instance's own), before the first pose and after the last it stands there.
struct Mover {
  uint32_t instance = 0;
  Trajectory world_from_object;
};

/// Models and where they stand. An opaque or permeable ground is a model like any other.
struct Scene {
  std::vector<Model> models;
  std::vector<Instance> instances;

  /// Throws `std::invalid_argument` where a model is bad, an instance names none, a pose or scale
  /// is not finite or a scale is not positive.
  void check() const;
};

}  // namespace underbrush::elements
