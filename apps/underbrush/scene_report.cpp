#include "scene_report.hpp"

#include <fmt/format.h>

namespace underbrush::app {
namespace {

/// Counts the elements except those of the ground.
size_t elements_of(const primitives::Composition& c) {
  size_t elements = 0;
  for (const auto& m : c.scene.models) elements += m.size() - m.ground.size();
  return elements;
}

}  // namespace

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
