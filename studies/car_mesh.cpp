#include "studies/car_mesh.hpp"

#include <algorithm>

#include "studies/solid.hpp"

namespace underbrush::studies {

elements::Model road_user(perception::ObjectClass label, const Vec3& size) {
  using perception::ObjectClass;
  const double bottom = -size.z() / 2 + std::min(0.2, size.z() / 4);
  const double height = size.z() / 2 - bottom;
  Solid solid;
  if (label == ObjectClass::kCar) {
    solid = block({0, 0, bottom}, {size.x(), size.y(), 0.55 * height});
    add_solid(solid, block({-0.05 * size.x(), 0, bottom + 0.55 * height},
                           {0.55 * size.x(), 0.85 * size.y(), 0.45 * height}));
  } else {
    const bool is_narrow = label == ObjectClass::kCyclist || label == ObjectClass::kPedestrian;
    solid = block({0, 0, bottom}, {size.x(), (is_narrow ? 0.5 : 1.0) * size.y(), height});
  }
  elements::Model model;
  model.fitter = "mesh";
  model.surface = triangulated(solid).mesh;
  model.surface.hit.assign(model.surface.triangles.size(), {});
  model.surface.range_sigma_m = 0.02;
  return model;
}

}  // namespace underbrush::studies
