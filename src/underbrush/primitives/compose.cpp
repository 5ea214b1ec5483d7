#include "underbrush/primitives/compose.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/primitives/adapt.hpp"

namespace underbrush::primitives {
namespace {

using elements::Class;

enum Draw : uint32_t { kKeep, kChoose, kShiftX, kShiftY, kTurn };

double uniform(uint64_t seed, size_t object, size_t copy, Draw what) {
  return uniform_from_bits(
      random_bits(beam_key(seed, object, copy), uint32_t(what), Purpose::kPlace));
}

/// All that `adapted` takes of an object.
using Shape = std::vector<double>;
Shape shape_of(const PlacedObject& o) {
  Shape out;
  const auto add = [&](const Vec3& v) { out.insert(out.end(), v.begin(), v.end()); };
  add(o.box.min);
  add(o.box.max);
  out.insert(out.end(), o.layers.z.begin(), o.layers.z.end());
  for (const auto& layers : {o.layers.x, o.layers.y}) {
    for (const PointLayers::Places& places : layers) {
      out.insert(out.end(), places.begin(), places.end());
    }
  }
  for (const auto& thirds : {o.beams.returns, o.beams.path_m}) {
    out.insert(out.end(), thirds.begin(), thirds.end());
  }
  return out;
}

/// Adds the cells of a patch that is annotated as a whole; any other object is added as it is.
void add_cells(const PlacedObject& o, double cell_m, std::vector<PlacedObject>& out) {
  const Vec3 size = o.box.size();
  if (elements::kind_of(o.label) != elements::ClassKind::kPatch ||
      size.head<2>().maxCoeff() <= 1.5 * cell_m) {
    out.push_back(o);
    return;
  }
  const int nx = std::max(1, int(std::lround(size.x() / cell_m)));
  const int ny = std::max(1, int(std::lround(size.y() / cell_m)));
  const Vec3 step(size.x() / nx, size.y() / ny, 0);
  for (int k = 0; k < nx * ny; ++k) {
    const Vec3 middle = o.box.min + Vec3((k % nx + 0.5) * step.x(), (k / nx + 0.5) * step.y(), 0);
    PlacedObject cell = o;
    cell.layers = {};  // They are of the whole patch.
    cell.beams = {};
    cell.position = o.world_from_object() * Vec3(middle.x(), middle.y(), 0);
    cell.box.min = Vec3(-0.5 * step.x(), -0.5 * step.y(), 0);
    cell.box.max = Vec3(0.5 * step.x(), 0.5 * step.y(), o.box.max.z());
    out.push_back(cell);
  }
}

}  // namespace

struct Composer::Impl {
  Impl(const elements::Model& ground, const PrimitiveSet& s, const ComposeOptions& o)
      : set(s),
        options(o),
        chooser(s, o.choose, o.nearest),
        models_of_entries(s.entries.size(), 0) {
    require(o.nearest > 0, "compose: at least one primitive must be chosen from");
    for (const auto& [label, factor] : o.density) {
      require(factor >= 0 && factor <= 100, "compose: a density must lie in [0, 100]");
    }
    composition.scene.models.push_back(ground.like());
    composition.info.names.emplace_back("ground");
    elements::Instance foot;
    foot.world_from_model.translation = ground.origin;
    composition.scene.instances.push_back(foot);
    composition.info.labels.push_back(Class::kGround);
  }

  void add(const PlacedObject& o, size_t number) {
    ++composition.objects;
    const auto density = options.density.find(o.label);
    const double wanted = density == options.density.end() ? 1 : density->second;
    const auto copies = size_t(wanted + uniform(options.seed, number, 0, kKeep));
    for (size_t copy = 0; copy < copies; ++copy) {
      PlacedObject one = o;
      if (copy) {  // An added object stands within two of its sides from the annotated one.
        const double reach = 2 * o.box.size().head<2>().maxCoeff();
        one.position.x() += reach * (2 * uniform(options.seed, number, copy, kShiftX) - 1);
        one.position.y() += reach * (2 * uniform(options.seed, number, copy, kShiftY) - 1);
        one.yaw_rad = 2 * M_PI * uniform(options.seed, number, copy, kTurn);
      }
      place(one, number, copy);
    }
  }

  void place(const PlacedObject& o, size_t number, size_t copy) {
    const std::vector<uint32_t>& from = chooser.candidates(o.label);
    if (from.empty()) {
      ++composition.left_out[std::string(elements::name(o.label))];
      return;
    }
    const std::optional<double> z = surface->at(o.position.x(), o.position.y());
    if (!z) {
      ++composition.off_ground;
      return;
    }
    const uint32_t chosen = chooser.choose(from, o, uniform(options.seed, number, copy, kChoose));
    const PrimitiveEntry& entry = set.entries[chosen];
    if (entry.label != o.label) ++composition.borrowed[std::string(elements::name(o.label))];
    const bool adapts = options.choose == Choice::kBest && !options.scale && can_adapt(entry, o);
    elements::Instance instance;
    instance.model = adapts ? adapted_model_of(chosen, o) : model_of(chosen);
    const Vec3 a = entry.box.size(), b = o.box.size();
    if (options.scale) instance.scale = float(a.dot(b) / a.dot(a));
    box_distance_m += (double(instance.scale) * a - b).norm();
    // The boxes are aligned: their middles agree and their bottoms stand on the ground.
    const Box& box = adapts ? o.box : entry.box;
    const Pose pose = o.world_from_object();
    const Vec3 middle =
        0.5 * (o.box.min + o.box.max) - double(instance.scale) * 0.5 * (box.min + box.max);
    const double up_m = -double(instance.scale) * box.min.z();
    instance.world_from_model.rotation = pose.rotation;
    instance.world_from_model.translation = pose * Vec3(middle.x(), middle.y(), 0);
    instance.world_from_model.translation.z() = *z + up_m;
    if (!o.trajectory.empty() && copy == 0) {
      add_mover(o.trajectory, {{1, 0, 0, 0}, {middle.x(), middle.y(), up_m}});
    }
    composition.scene.instances.push_back(instance);
    composition.info.labels.push_back(o.label);
    composition.object_of.push_back(uint32_t(number));
    ++composition.placed;
  }

  /// Adds the motion of the instance that is added next.
  void add_mover(const std::filesystem::path& file, const Pose& foot_from_model) {
    std::vector<StampedPose> poses = io::read_trajectory(file).poses();
    for (StampedPose& p : poses) p.world_from_sensor = p.world_from_sensor * foot_from_model;
    composition.info.movers.push_back(
        {uint32_t(composition.scene.instances.size()), Trajectory(std::move(poses))});
  }

  uint32_t model_of(uint32_t entry) {
    uint32_t& model = models_of_entries[entry];
    if (model == 0) model = add_model(read_primitive(set, entry), entry);
    return model;
  }

  /// Objects that are alike, as those of a generated site that is like another, share a model.
  uint32_t adapted_model_of(uint32_t entry, const PlacedObject& o) {
    uint32_t& model = adapted_models[{entry, shape_of(o)}];
    if (model == 0) {
      model = add_model(adapted(read_primitive(set, entry), set.entries[entry], o), entry);
    }
    return model;
  }

  uint32_t add_model(elements::Model added, uint32_t entry) {
    // The scene reaches as far as the sensor that saw the primitives.
    elements::Model& scene = composition.scene.models[0];
    if (added.max_range_m < scene.max_range_m) {
      scene.max_range_m = added.max_range_m;
      scene.sensor = added.sensor;
      scene.sensor_file = added.sensor_file;
    }
    composition.scene.models.push_back(std::move(added));
    composition.info.names.push_back(set.entries[entry].name);
    return uint32_t(composition.scene.models.size() - 1);
  }

  const PrimitiveSet& set;
  ComposeOptions options;
  const GroundSurface* surface = nullptr;
  Chooser chooser;
  std::vector<uint32_t> models_of_entries;
  std::map<std::pair<uint32_t, Shape>, uint32_t> adapted_models;
  double box_distance_m = 0;
  Composition composition;
};

Composer::Composer(const elements::Model& ground, const PrimitiveSet& set, const ComposeOptions& o)
    : impl_(std::make_unique<Impl>(ground, set, o)) {}
Composer::~Composer() = default;

void Composer::add(const GroundSurface& ground, const std::vector<PlacedObject>& annotated,
                   const ComposeProgress& progress) {
  impl_->surface = &ground;
  std::vector<PlacedObject> cells;
  for (size_t k = 0; k < annotated.size(); ++k) {
    cells.clear();
    add_cells(annotated[k], impl_->set.cell_m, cells);
    for (const PlacedObject& o : cells) impl_->add(o, impl_->composition.objects);
    if (progress && k % 256 == 0) progress(k, annotated.size());
  }
  if (impl_->composition.placed == 0) return;
  impl_->composition.mean_box_distance_m =
      impl_->box_distance_m / double(impl_->composition.placed);
}

void Composer::forget_below(double y_m) { impl_->chooser.forget_below(y_m); }

Composition& Composer::result() { return impl_->composition; }

std::map<Class, double> densities_of(const std::vector<std::string>& words) {
  std::map<Class, double> out;
  for (const std::string& word : words) {
    const size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const auto label = elements::class_from_name(name);
    if (!label) {
      const std::string near =
          nearest_name(name, {elements::kClassNames.begin(), elements::kClassNames.end()});
      throw std::invalid_argument("compose: no class '" + name + "'" +
                                  (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    const auto factor = io::number_of(equals == std::string::npos ? "" : word.substr(equals + 1));
    if (!factor || !(*factor >= 0 && *factor <= 100)) {
      throw std::invalid_argument(
          "compose: expected CLASS=FACTOR with a factor in [0, 100], not '" + word + "'");
    }
    out[*label] = *factor;
  }
  return out;
}

Composition compose(const Annotation& annotation, const elements::Model& ground,
                    const PrimitiveSet& set, const ComposeOptions& o,
                    const ComposeProgress& progress) {
  Composer composer(ground, set, o);
  composer.add(GroundSurface(ground), annotation.objects, progress);
  Composition out = std::move(composer.result());
  out.scene.models[0].ground = ground.ground;
  return out;
}

}  // namespace underbrush::primitives
