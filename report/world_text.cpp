#include "report/world_text.hpp"

#include <fmt/format.h>

#include <map>

namespace underbrush::report {
namespace {

/// Returns the number of parts of each class.
std::map<std::string, size_t> classes_of(const elements::SceneInfo& info) {
  std::map<std::string, size_t> classes;
  for (size_t k = 1; k < info.labels.size(); ++k) {
    ++classes[elements::class_name(info, info.labels[k])];
  }
  return classes;
}

}  // namespace

Json json_of(const WorldSummary& world) {
  const worlds::WorldReport& r = world.read;
  Json j;
  j["parts"] = r.parts;
  j["triangles"] = r.triangles;
  j["voxels"] = r.voxels;
  j["offset_m"] = {r.offset_m.x(), r.offset_m.y(), r.offset_m.z()};
  j["rounding_m"] = r.rounding_m;
  j["unit_m"] = r.unit_m;
  j["up"] = r.y_up ? "y" : "z";
  j["classes"] = classes_of(world.info);
  j["element_classes"] = elements::element_classes(world.info);
  j["materials"] = Json::array();
  for (const auto& m : world.info.own_materials) j["materials"].push_back(m.name);
  j["without_material"] = r.without_material;
  j["left_out"] = r.left_out;
  return j;
}

std::string text_of(const WorldSummary& world) {
  const worlds::WorldReport& r = world.read;
  std::string text =
      fmt::format("  world       {} parts, {} triangles, {} voxels, {} materials of its own\n",
                  r.parts, r.triangles, r.voxels, world.info.own_materials.size());
  text += fmt::format(
      "  coordinates stored from {:.15g} {:.15g} {:.15g} m on, rounded by at most "
      "{:.1g} m{}\n",
      r.offset_m.x(), r.offset_m.y(), r.offset_m.z(), r.rounding_m,
      r.y_up ? "; x y z of the file are x -z y" : "");
  if (r.unit_m != 1) text += fmt::format("  unit        {:g} m\n", r.unit_m);
  std::string classes;
  size_t shown = 0;
  for (const auto& [name, n] : classes_of(world.info)) {
    if (++shown > 12) break;
    classes += (classes.empty() ? "" : ", ") + name + fmt::format(" ({})", n);
  }
  text += fmt::format("  classes     {}{}\n", classes, shown > 12 ? ", …" : "");
  if (r.without_material) {
    text += fmt::format(
        "  materials   {} parts without a reflectance of their own have the material "
        "of their class\n",
        r.without_material);
  }
  for (const auto& [what, n] : r.left_out) text += fmt::format("  left out    {} ({})\n", n, what);
  return text;
}

}  // namespace underbrush::report
