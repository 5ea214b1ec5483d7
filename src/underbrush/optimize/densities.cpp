#include "underbrush/optimize/densities.hpp"

#include <set>

namespace underbrush::optimize {

std::vector<Parameter> density_parameters(const primitives::Annotation& annotation) {
  std::set<elements::Class> classes;
  for (const primitives::PlacedObject& o : annotation.objects) classes.insert(o.label);
  std::vector<Parameter> out;
  out.reserve(classes.size());
  for (const elements::Class c : classes) {
    out.push_back({std::string(elements::name(c)), 0.1, 4, Scale::kLog});
  }
  return out;
}

Outcome scene_outcome(const std::string& objective, const SceneParts& parts,
                      primitives::ComposeOptions options, std::span<const Parameter> densities,
                      std::span<const double> value, const BeamLog& beams) {
  for (size_t k = 0; k < densities.size(); ++k) {
    options.density[*elements::class_from_name(densities[k].name)] = value[k];
  }
  const primitives::Composition composed =
      primitives::compose(parts.annotation, parts.ground, parts.primitives, options);
  const trace::World world(composed.scene);
  return outcome_of(objective, world, beams, options.seed);
}

}  // namespace underbrush::optimize
