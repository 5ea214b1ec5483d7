#include "underbrush/metrics/bounds.hpp"

namespace underbrush::metrics {
namespace {

void add_model(const elements::Model& m, const elements::Instance& placed, Bounds& bounds) {
  const auto world = [&](const Vec3f& v) -> Vec3 {
    return placed.world_from_model.translation +
           double(placed.scale) * (placed.world_from_model.rotation * v.cast<double>());
  };
  for (const Vec3f& v : m.ground.vertices) bounds.add(world(v));
  for (const Vec3f& v : m.surface.vertices) bounds.add(world(v));
  for (const elements::Ellipsoid& e : m.ellipsoids) {
    const Mat3 turned = placed.world_from_model.rotation.toRotationMatrix() *
                        e.covariance_matrix() *
                        placed.world_from_model.rotation.toRotationMatrix().transpose();
    const Vec3 reach = 2 * double(placed.scale) * turned.diagonal().cwiseSqrt();
    bounds.add(world(e.mean) - reach);
    bounds.add(world(e.mean) + reach);
  }
}

}  // namespace

Bounds bounds_of(std::span<const elements::Model> models,
                 std::span<const elements::Instance> instances) {
  Bounds bounds;
  if (instances.empty() && !models.empty()) {
    elements::Instance placed;
    placed.world_from_model.translation = models[0].origin;
    add_model(models[0], placed, bounds);
  }
  for (const elements::Instance& i : instances) add_model(models[i.model], i, bounds);
  return bounds;
}

}  // namespace underbrush::metrics
