#include "underbrush/credit/element_classes.hpp"

#include <algorithm>
#include <map>

#include "underbrush/credit/explaining.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::credit {
namespace {

/// The number in a model of a class of a label set, which is added where the model lacks it.
uint32_t class_in(elements::Model& model, std::string_view set, uint32_t number) {
  const std::string name = elements::label_name(set, number);
  if (elements::ground_label(set, number) == elements::GroundLabel::kUnknown) return 0;
  if (const auto known = model.class_number(name)) return *known;
  model.class_names.push_back(name);
  return *model.class_number(name);
}

/// Sets the usual grain of the classes that most ellipsoids have.
void set_usual_grain(elements::Model& model) {
  std::map<uint32_t, size_t> count;
  for (const elements::Ellipsoid& e : model.ellipsoids) count[e.label] += e.label != 0;
  std::vector<std::pair<size_t, uint32_t>> most;
  for (const auto& [label, n] : count) {
    if (n > 0) most.emplace_back(n, label);
  }
  std::stable_sort(most.begin(), most.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  model.grain.classes.clear();
  for (size_t k = 0; k < std::min(most.size(), elements::Grain::kMostClasses); ++k) {
    const uint32_t label = most[k].second;
    model.grain.classes.push_back({label, elements::usual_grain_m(model.class_name(label))});
  }
}

}  // namespace

void learn_classes(elements::Model& model, BeamSource& log, const std::vector<bool>& wanted) {
  const std::string set = log.info().classes;
  if (model.ellipsoids.empty() || set.empty()) return;
  std::map<std::pair<uint32_t, uint32_t>, size_t> count;  // of hits, by ellipsoid and number
  const trace::World world(model);
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    const auto column = chunk.extra.find("class");
    if (column == chunk.extra.end()) return;
    const std::vector<uint32_t> element = explaining_elements(world, chunk);
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (element[i] == trace::Intersection::kNone) continue;
      const elements::ElementPlace at = model.place(element[i]);
      if (at.kind != elements::Kind::kEllipsoid) continue;
      if (!wanted.empty() && !wanted[element[i]]) continue;
      ++count[{at.index, whole_number(column->second, i)}];
    }
  }
  struct Most {
    size_t hits = 0;
    uint32_t number = 0;
  };
  std::vector<Most> most(model.ellipsoids.size());
  for (const auto& [key, n] : count) {  // Of equal counts the smaller number wins.
    if (n > most[key.first].hits) most[key.first] = {n, key.second};
  }
  for (size_t i = 0; i < most.size(); ++i) {
    if (!wanted.empty() && !wanted[model.triangle_count() + i]) continue;
    model.ellipsoids[i].label = most[i].hits > 0 ? class_in(model, set, most[i].number) : 0;
  }
  if (wanted.empty()) set_usual_grain(model);
}

}  // namespace underbrush::credit
