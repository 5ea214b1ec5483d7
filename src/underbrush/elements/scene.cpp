#include "underbrush/elements/scene.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::elements {

void Scene::check() const {
  for (const Model& m : models) m.check();
  for (const Instance& i : instances) {
    require(i.model < models.size(), "scene: an instance names no model");
    require(i.world_from_model.translation.allFinite(), "scene: a position is not finite");
    require(std::abs(i.world_from_model.rotation.norm() - 1) < 1e-6,
            "scene: a rotation is not of unit norm");
    require(std::isfinite(i.scale) && i.scale > 0, "scene: a scale is not positive");
  }
}

}  // namespace underbrush::elements
