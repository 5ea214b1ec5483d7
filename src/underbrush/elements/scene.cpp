#include "underbrush/elements/scene.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::elements {

void Scene::check() const {
  for (const Model& m : models) m.check();
  require(numbers.empty() ||
              (numbers.size() == instances.size() &&
               std::ranges::adjacent_find(numbers, std::greater_equal<>()) == numbers.end()),
          "scene: the numbers of the instances of a part do not ascend");
  for (const Instance& i : instances) {
    require(i.model < models.size(), "scene: an instance names no model");
    require(i.world_from_model.translation.allFinite(), "scene: a position is not finite");
    require(std::abs(i.world_from_model.rotation.norm() - 1) < 1e-6,
            "scene: a rotation is not of unit norm");
    require(std::isfinite(i.scale) && i.scale > 0, "scene: a scale is not positive");
  }
}

double sway_of(std::span<const Model> models) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Model& m : models) {
    if (m.whole_count(Kind::kEllipsoid) == 0) continue;
    if (m.sway_s == 0) return 0;
    shortest = std::min(shortest, m.sway_s);
  }
  return std::isfinite(shortest) ? shortest : 0;
}

}  // namespace underbrush::elements
