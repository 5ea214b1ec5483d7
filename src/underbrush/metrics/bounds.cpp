#include "underbrush/metrics/bounds.hpp"

#include <vector>

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

/// A box around what `add_model` adds, from the model's own box, a little larger than it.
Bounds around(const Bounds& own, const elements::Instance& placed) {
  Bounds box;
  if (own.empty()) return box;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner(k & 1 ? own.high.x() : own.low.x(), k & 2 ? own.high.y() : own.low.y(),
                      k & 4 ? own.high.z() : own.low.z());
    box.add(placed.world_from_model * Vec3(double(placed.scale) * corner));
  }
  // More than coordinates are rounded by.
  const double margin = 1e-6 + 1e-9 * box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).maxCoeff();
  return {box.low.array() - margin, box.high.array() + margin};
}

}  // namespace

void add_bounds(std::span<const elements::Model> models,
                std::span<const elements::Instance> instances, Bounds& bounds) {
  if (instances.empty() && !models.empty()) {
    elements::Instance placed;
    placed.world_from_model.translation = models[0].origin;
    add_model(models[0], placed, bounds);
  }
  std::vector<Bounds> own(models.size());
  for (size_t m = 0; !instances.empty() && m < models.size(); ++m) add_model(models[m], {}, own[m]);
  for (const elements::Instance& i : instances) {
    if (!bounds.contains(around(own[i.model], i))) add_model(models[i.model], i, bounds);
  }
}

Bounds bounds_of(std::span<const elements::Model> models,
                 std::span<const elements::Instance> instances) {
  Bounds bounds;
  add_bounds(models, instances, bounds);
  return bounds;
}

}  // namespace underbrush::metrics
