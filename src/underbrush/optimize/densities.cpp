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

}  // namespace underbrush::optimize
