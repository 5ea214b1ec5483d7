#include "objects_of_log.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>

#include "cli/progress.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/ground/height_grid.hpp"
#include "underbrush/ground/triangulate.hpp"

namespace underbrush::app {
namespace {

std::map<elements::Class, size_t> classes_of(const primitives::MeasuredObjects& measured) {
  std::map<elements::Class, size_t> classes;
  for (const auto& o : measured.objects) ++classes[o.label];
  return classes;
}

}  // namespace

void require_objects(const std::string& file, BeamSource& log) {
  log.rewind();
  BeamLog chunk;
  log.next(chunk);
  if (!chunk.extra.count("class") || !chunk.extra.count("instance") ||
      log.info().classes != "underbrush") {
    throw FormatError(
        file, "", "has no objects: it needs the columns class and instance that segment writes");
  }
}

elements::Model ground_of_log(const std::string& file, BeamSource& log, double spacing_m) {
  Progress progress("ground");
  std::optional<ground::HeightGrid> grid;
  ground::HeightGridOptions options;
  options.spacing_m = 0.5 * spacing_m;
  if (const auto origin = log_origin(log)) grid.emplace(*origin, options);
  size_t done = 0;
  for (BeamLog chunk; log.next(chunk);) {
    std::vector<Vec3> points;
    const ExtraColumn& label = chunk.extra.at("class");
    for (size_t i = 0; i < chunk.size(); ++i) {
      const auto c = elements::Class(whole_number(label, i));
      if (chunk.is_hit(i) && c == elements::Class::kGround) points.push_back(chunk.end_point(i));
    }
    if (grid) grid->add(points);
    progress(done += chunk.size(), log.size());
  }
  if (!grid || grid->points() == 0) throw FormatError(file, "", "none of its points is ground");
  const ground::HeightMap map = grid->solve();
  ground::GroundMesh mesh = ground::triangulate(map);
  elements::Model model;
  model.origin = mesh.origin;
  model.ground.vertices = std::move(mesh.vertices);
  model.ground.triangles = std::move(mesh.triangles);
  model.ground.hit.resize(model.ground.size());
  model.ground.range_sigma_m = map.sigma_m;
  model.fitter = "ground";
  return model;
}

Json json_of(const primitives::MeasuredObjects& measured) {
  Json j;
  j["objects"] = measured.objects.size();
  for (const auto& [label, n] : classes_of(measured)) j["classes"][std::string(name(label))] = n;
  j["few_points"] = measured.few_points;
  j["off_ground"] = measured.off_ground;
  j["hits_without_instance"] = measured.without_instance;
  return j;
}

std::string text_of(const primitives::MeasuredObjects& measured) {
  std::string text = fmt::format("{} objects\n", measured.objects.size());
  for (const auto& [label, n] : classes_of(measured)) {
    text += fmt::format("  {:<19}{:>8}\n", name(label), n);
  }
  if (measured.objects.empty()) text += "  warning     nothing stands on this ground\n";
  return text +
         left_out({{"objects or cells of few points", measured.few_points},
                   {"objects off the ground", measured.off_ground},
                   {"hits of an object's class without instance", measured.without_instance}});
}

std::string left_out(const std::vector<std::pair<std::string, size_t>>& counts) {
  std::string text;
  for (const auto& [what, n] : counts) {
    if (n) text += fmt::format("  left out    {} {}\n", n, what);
  }
  return text;
}

}  // namespace underbrush::app
