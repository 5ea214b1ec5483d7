#include "underbrush/fit/element_classes.hpp"

#include <algorithm>
#include <map>

#include "underbrush/core/parallel.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/fit/hit_probability.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {
namespace {

constexpr uint32_t kNowhere = trace::Intersection::kNone;

/// Finds the ellipsoid that explains each hit of a chunk best, by its place in the model, or
/// `kNowhere`.
std::vector<uint32_t> explaining(const trace::World& world, const BeamLog& chunk) {
  const elements::Model& model = world.model();
  CreditOptions options;
  options.rule = "best";
  const trace::RangeLimits limits{chunk.info.min_range_m,
                                  std::min(chunk.info.max_range_m, model.max_range_m)};
  std::vector<uint32_t> found(chunk.size(), kNowhere);
  parallel_for(chunk.size(), 2048, [&](size_t begin, size_t end) {
    std::vector<size_t> hits;
    std::vector<Ray> rays;
    std::vector<double> reach;
    for (size_t i = begin; i < end; ++i) {
      if (!chunk.is_hit(i)) continue;
      hits.push_back(i);
      rays.push_back(chunk.ray(i));
      reach.push_back(
          std::min(double(chunk.range_m[i]) + options.max_residual_for_hit_m, limits.max_m));
    }
    trace::IntersectionLists met;
    world.all_intersections(rays, limits, reach, met, trace::World::Sequence::kAny);
    std::vector<Credit> said;
    for (size_t h = 0; h < hits.size(); ++h) {
      credit(model, met[h], chunk.range_m[hits[h]], options, said);
      const auto hit = std::find(said.begin(), said.end(), Credit::kHit);
      if (hit == said.end()) continue;
      const elements::ElementPlace place = model.place(met[h][size_t(hit - said.begin())].element);
      if (place.kind == elements::Kind::kEllipsoid) found[hits[h]] = place.index;
    }
  });
  return found;
}

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

void learn_classes(elements::Model& model, BeamSource& log) {
  const std::string set = log.info().classes;
  if (model.ellipsoids.empty() || set.empty()) return;
  std::map<std::pair<uint32_t, uint32_t>, size_t> count;  // of hits, by ellipsoid and number
  const trace::World world(model);
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    const auto column = chunk.extra.find("class");
    if (column == chunk.extra.end()) return;
    const std::vector<uint32_t> ellipsoid = explaining(world, chunk);
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (ellipsoid[i] != kNowhere) ++count[{ellipsoid[i], whole_number(column->second, i)}];
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
    model.ellipsoids[i].label = most[i].hits > 0 ? class_in(model, set, most[i].number) : 0;
  }
  set_usual_grain(model);
}

}  // namespace underbrush::fit
