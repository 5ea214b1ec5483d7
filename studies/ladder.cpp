#include "studies/ladder.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/credit/hit_probability.hpp"
#include "underbrush/likelihood/maximisation.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/primitives/adapt.hpp"

namespace underbrush::studies {
namespace {

constexpr size_t kMostCompared = 200;  // Ellipsoids of a primitive whose neighbours are searched.

using elements::Model;
using primitives::PlacedObject;
using primitives::Primitive;

/// A place in the test log: the object's instance and where it stands.
using ObjectPlace = std::tuple<uint32_t, double, double>;
ObjectPlace place_of(const PlacedObject& o) { return {o.instance, o.position.x(), o.position.y()}; }

/// The rungs of one pair.
class Climb {
 public:
  Climb(const SitePair& pair, uint64_t seed)
      : pair_(pair), seed_(seed), test_(fit_of_log(pair.test, pair.min_range_m, seed)) {
    test_.keyframes = nullptr;
    const Model trained = fit_of_log(pair.train, pair.min_range_m, seed);
    site_ = annotated_site(pair.test, trained.max_range_m);
    cut_ = cut_primitives(pair, trained, site_).primitives;
    require(!cut_.empty(), "study: no primitive is left of the training log");
  }

  std::vector<Rung> rungs() && {
    composed();
    chosen_scenes();
    own_primitives_scene();
    add("and what stands in no box", pipeline::TracedWorld(test_));
    out_.push_back(
        {"always hit", scores_of(pair_.test, metrics::always_hit(pair_.train, pair_.test)).all});
    return std::move(out_);
  }

 private:
  void add(const std::string& name, const pipeline::TracedWorld& world) {
    out_.push_back({name, scores_of(pair_.test, answers_of_world(world, pair_.test, seed_)).all});
  }
  void add(const std::string& name, const elements::Scene& scene, const elements::SceneInfo& info) {
    add(name, pipeline::TracedWorld(scene, info));
  }

  void composed() {
    pipeline::ComposeOptions options;
    options.seed = seed_;
    const primitives::PrimitiveSet set =
        primitives::primitive_set(cut_, primitives::MeasureOptions{}.cell_m);
    options.choose = "box";
    const primitives::Composition boxes =
        pipeline::compose_scene(site_.annotation, site_.ground, set, options);
    add("chosen by the box alone", boxes.scene, boxes.info);
    options.choose = "best";
    const primitives::Composition first =
        pipeline::compose_scene(site_.annotation, site_.ground, set, options);
    add("composed", first.scene, first.info);
    composition_ = pipeline::compose_scene(site_.annotation, test_, set, options);
    add("ground of the fit", composition_.scene, composition_.info);
  }

  /// Puts a primitive of its own in the place of each instance: `model_of(object, model)` returns
  /// it in the object's frame; nothing leaves out the instance.
  template <class ModelOf>
  primitives::Composition replaced(const ModelOf& model_of) const {
    primitives::Composition out;
    const elements::Scene& from = composition_.scene;
    out.scene.models = {from.models[0]};
    out.scene.instances = {from.instances[0]};
    out.info.names = {"ground"};
    out.info.labels = {elements::Class::kGround};
    const primitives::GroundSurface surface(test_);
    for (size_t k = 1; k < from.instances.size(); ++k) {
      const PlacedObject& o = site_.annotation.objects[composition_.object_of[k - 1]];
      std::optional<Model> model = model_of(o, from.instances[k].model);
      if (!model) continue;
      elements::Instance instance;
      instance.world_from_model = o.world_from_object();
      instance.world_from_model.translation.z() = *surface.at(o.position.x(), o.position.y());
      instance.model = uint32_t(out.scene.models.size());
      out.scene.models.push_back(std::move(*model));
      out.scene.instances.push_back(instance);
      out.info.names.push_back(std::to_string(k));
      out.info.labels.push_back(o.label);
    }
    return out;
  }

  void chosen_scenes() {
    own_ = own_primitives();
    entries_ = primitives::primitive_set(cut_, 1).entries;
    const primitives::Composition chosen = replaced([&](const PlacedObject& o, uint32_t model) {
      return nearest(o, composition_.scene.models[model]);
    });
    add("chosen by shape", chosen.scene, chosen.info);
    add("matter of the test log", pipeline::TracedWorld(with_true_matter(chosen.scene)));
  }

  /// The primitive of the object's class that, adapted to the object, is most like the object's
  /// own; `composed` where the object has none.
  std::optional<Model> nearest(const PlacedObject& o, const Model& composed) const {
    const auto own = own_.find(place_of(o));
    if (own == own_.end()) return composed;
    Model best = composed;
    double least = INFINITY;
    for (size_t k = 0; k < cut_.size(); ++k) {
      if (cut_[k].label != o.label || !primitives::can_adapt(entries_[k], o)) continue;
      Model m = primitives::adapted(cut_[k].model, entries_[k], o);
      const double d = shape_distance(m, own->second.model);
      if (d < least) least = d, best = std::move(m);
    }
    return best;
  }

  /// The shares of hits of the scene's elements on the test log.
  Model with_true_matter(const elements::Scene& scene) const {
    Model model = flattened(scene);
    const Model before = model;
    for (elements::Ellipsoid& e : model.ellipsoids) e.density_per_m = 0;
    MemorySource source(pair_.test);
    credit::count_hits(model, source, {});
    likelihood::MaximisationOptions plain;
    plain.spent_at_start = 0;
    model = likelihood::with_densities(model, before.range_noise_m, plain);
    for (size_t k = 0; k < model.ellipsoids.size(); ++k) {
      const elements::HitCount& h = model.ellipsoids[k].hit;
      if (h.hits + h.misses == 0) model.ellipsoids[k] = before.ellipsoids[k];
    }
    model.ground = before.ground;
    return model;
  }

  std::map<ObjectPlace, Primitive> own_primitives() const {
    std::map<ObjectPlace, Primitive> out;
    MemorySource source(pair_.test);
    for (Primitive& p : pipeline::extract_primitives(test_, "test log", source, {}).primitives) {
      const ObjectPlace place = place_of(p.source);
      out.emplace(place, std::move(p));
    }
    return out;
  }

  void own_primitives_scene() {
    const auto own = [&](const PlacedObject& o, uint32_t) -> std::optional<Model> {
      const auto found = own_.find(place_of(o));
      if (found == own_.end()) return std::nullopt;
      return found->second.model;
    };
    const primitives::Composition kept = replaced(own);
    add("the plants' own primitives", kept.scene, kept.info);
  }

  const SitePair& pair_;
  uint64_t seed_;
  Model test_;  ///< The fit of the test log, without keyframes.
  AnnotatedSite site_;
  std::vector<Primitive> cut_;
  std::vector<primitives::PrimitiveEntry> entries_;  ///< The entries of `cut_`.
  primitives::Composition composition_;              ///< On the ground of the fit.
  std::map<ObjectPlace, Primitive> own_;
  std::vector<Rung> out_;
};

}  // namespace

double shape_distance(const Model& a, const Model& b) {
  double sum = 0;
  for (const auto& [from, to] : {std::pair{&a, &b}, {&b, &a}}) {
    double weights = 0, distances = 0;
    const size_t step = 1 + from->ellipsoids.size() / kMostCompared;
    for (size_t k = 0; k < from->ellipsoids.size(); k += step) {
      const elements::Ellipsoid& e = from->ellipsoids[k];
      float least = INFINITY;
      for (const elements::Ellipsoid& f : to->ellipsoids) {
        least = std::min(least, (e.mean - f.mean).squaredNorm());
      }
      weights += e.hit.hits + 1.0;
      distances += (e.hit.hits + 1.0) * std::sqrt(double(least));
    }
    sum += 0.5 * distances / weights;
  }
  return sum;
}

Model flattened(const elements::Scene& scene) {
  Model out = scene.models.at(scene.instances.at(0).model);
  for (size_t k = 1; k < scene.instances.size(); ++k) {
    const elements::Instance& instance = scene.instances[k];
    const Mat3 turn =
        double(instance.scale) * instance.world_from_model.rotation.toRotationMatrix();
    for (elements::Ellipsoid e : scene.models[instance.model].ellipsoids) {
      const Vec3 mean = turn * e.mean.cast<double>() + instance.world_from_model.translation;
      e.mean = (mean - out.origin).cast<float>();
      e.set_covariance(turn * e.covariance_matrix() * turn.transpose());
      e.density_per_m /= instance.scale;
      out.ellipsoids.push_back(e);
    }
  }
  return out;
}

std::vector<Rung> ladder(const SitePair& pair, uint64_t seed) { return Climb(pair, seed).rungs(); }

}  // namespace underbrush::studies
