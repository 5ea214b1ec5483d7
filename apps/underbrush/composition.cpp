#include "composition.hpp"

#include "cli/progress.hpp"

#include <fmt/format.h>

#include "plant_sources.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

/// But those of the ground.
size_t elements_of(const primitives::Composition& c) {
  size_t elements = 0;
  for (const auto& m : c.scene.models) elements += m.size() - m.ground.size();
  return elements;
}

}  // namespace

NamedSet primitives_named(const std::string& name, uint64_t seed) {
  if (name != kMeshPrimitives) return {primitives::read_primitive_set(name), {name}, {}};
  NamedSet out;
  primitives::MeshPrimitiveOptions options;
  options.seed = seed;
  out.set = primitives::primitive_set(primitives::mesh_primitives(generated_plants(seed), options),
                                      options.cell_m);
  if (fs::exists(fs::path(name) / "primitives.json")) {
    out.warnings.push_back(fmt::format(
        "{0} is the set of the generated plants; the folder of that name is ./{0}", name));
  }
  return out;
}

primitives::Composition composed(const primitives::Annotation& annotation,
                                 const elements::Model& ground, const primitives::PrimitiveSet& set,
                                 const primitives::ComposeOptions& options) {
  Progress progress("compose");
  return primitives::compose(annotation, ground, set, options, std::ref(progress));
}

Json json_of(const primitives::Composition& c) {
  Json j;
  j["objects"] = c.objects;
  j["instances"] = c.placed;
  j["models"] = c.scene.models.size() - 1;
  j["elements"] = elements_of(c);
  j["off_ground"] = c.off_ground;
  j["left_out"] = c.left_out;
  j["borrowed"] = c.borrowed;
  j["mean_box_distance_m"] = c.mean_box_distance_m;
  return j;
}

std::string text_of(const primitives::Composition& c) {
  std::string text = fmt::format(
      "{} objects: {} instances of {} primitives ({} elements), boxes {:.2f} m apart on average\n",
      c.objects, c.placed, c.scene.models.size() - 1, elements_of(c), c.mean_box_distance_m);
  if (c.objects == 0) text += "  warning     there are no objects: the scene is its ground\n";
  for (const auto& [label, n] : c.borrowed) {
    text += fmt::format(
        "  warning     {} of class {}: no primitives, placed with those of another size\n", n,
        label);
  }
  for (const auto& [label, n] : c.left_out) {
    text +=
        fmt::format("  warning     {} of class {} left out: no primitives of its kind\n", n, label);
  }
  if (c.off_ground) {
    text +=
        fmt::format("  warning     {} left out: they stand off the ground mesh\n", c.off_ground);
  }
  return text;
}

}  // namespace underbrush::app
