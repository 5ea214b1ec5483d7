#include "underbrush/primitives/log_ground.hpp"

#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/ground/height_grid.hpp"
#include "underbrush/ground/triangulate.hpp"

namespace underbrush::primitives {

elements::Model ground_of_log(const std::string& file, BeamSource& log, double spacing_m,
                              const MeasureProgress& progress) {
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
    done += chunk.size();
    if (progress) progress(done, log.size());
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

}  // namespace underbrush::primitives
