#include "underbrush/pipeline/world.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"

namespace underbrush::pipeline {
namespace {

Matter resolved(Matter matter, std::span<const elements::Model> models) {
  require((!matter.anew && !matter.still) || matter.sway_s == 0,
          "simulate: --wind moves matter that is drawn once, not --matter anew or still");
  if (!matter.anew && !matter.still && matter.sway_s == 0)
    matter.sway_s = elements::sway_of(models);
  return matter;
}

trace::Draws draws_of(const Matter& matter) {
  if (matter.anew) return trace::Draws::kAnew;
  return matter.sway_s > 0 ? trace::Draws::kSwaying : trace::Draws::kOnce;
}

}  // namespace

World read_world(const std::filesystem::path& path, const worlds::ReadOptions& options) {
  World out;
  if (elements::is_scene(path)) {
    out.scene = elements::read_scene(path, &out.info);
  } else if (regions::is_world(path)) {
    regions::WorldPart whole = regions::WorldFolder(path).whole();
    out = {std::move(whole.scene), std::move(whole.info), {}};
  } else if (worlds::is_world(path)) {
    worlds::World world = worlds::read_world(path, options);
    out = {std::move(world.scene), std::move(world.info), std::move(world.report)};
  } else {
    out.scene.models.push_back(elements::read_model(path));
    out.info.class_names = out.scene.models[0].class_names;
  }
  return out;
}

World open_world(const std::filesystem::path& path, const worlds::ReadOptions& options) {
  check_options("simulate", worlds::read_options(), options);
  if (!regions::is_world(path)) return pipeline::read_world(path, options);
  auto folder = std::make_shared<const regions::WorldFolder>(path);
  regions::WorldPart common = folder->part({});
  return {std::move(common.scene), std::move(common.info), {}, std::move(folder)};
}

elements::Model read_ground(const std::filesystem::path& path) {
  elements::Model model = elements::read_model(path);
  if (model.ground.size() == 0) throw FormatError(path.string(), "", "the model has no ground");
  return model;
}

void add_mover(World& world, elements::Model model, Trajectory world_from_object,
               const std::string& material, const std::string& name) {
  elements::Scene& scene = world.scene;
  elements::SceneInfo& info = world.info;
  if (scene.instances.empty()) {  // The scene is a model.
    elements::Instance placed;
    placed.world_from_model.translation = scene.models[0].origin;
    scene.instances.push_back(placed);
    info.labels.push_back(elements::Class::kUnknown);
  }
  info.materials.resize(scene.models.size());
  info.names.resize(scene.models.size());
  if (!scene.numbers.empty()) {
    scene.numbers.push_back(std::max(scene.numbers.back() + 1, world.regions->index().instances()));
  }
  info.movers.push_back({uint32_t(scene.instances.size()), std::move(world_from_object)});
  scene.instances.emplace_back();
  scene.instances.back().model = uint32_t(scene.models.size());
  scene.models.push_back(std::move(model));
  info.labels.push_back(elements::Class::kUnknown);
  info.materials.push_back(material);
  info.names.push_back(name);
}

void add_actors(World& world, std::vector<actors::Actor> actors) {
  const double sway_s = elements::sway_of(world.scene.models);
  for (actors::Actor& a : actors) {
    add_mover(world, std::move(a.model), std::move(a.world_from_actor), "", a.name);
    world.scene.models.back().sway_s = sway_s;
    world.info.labels.back() = elements::class_named(world.info, a.label);
    world.info.movers.back().from_s = a.from_s;
    world.info.movers.back().to_s = a.to_s;
  }
}

std::unique_ptr<TracedWorld> open_part(const TracedWorld& world,
                                       std::span<const uint32_t> regions) {
  const World& common = *world.own();
  regions::WorldPart read = world.regions()->part(regions);
  World part{std::move(read.scene), std::move(read.info), {}};
  auto& [models, instances, numbers] = part.scene;
  for (size_t m = 0; m < models.size(); ++m) {
    models[m].tau = common.scene.models[m].tau;
    models[m].grain = common.scene.models[m].grain;
  }
  // What was added follows the instances that the world's folder has in common.
  const auto from = std::ptrdiff_t(world.regions()->index().common_instances.size());
  const auto to = std::ptrdiff_t(instances.size());
  const auto append = [](auto& values, const auto& all, std::ptrdiff_t first) {
    if (first < std::ptrdiff_t(all.size()))
      values.insert(values.end(), all.begin() + first, all.end());
  };
  append(models, common.scene.models, std::ptrdiff_t(models.size()));
  append(instances, common.scene.instances, from);
  append(numbers, common.scene.numbers, from);
  append(part.info.labels, common.info.labels, from);
  const auto movers = std::ptrdiff_t(part.info.movers.size());
  append(part.info.movers, common.info.movers, movers);
  for (auto m = part.info.movers.begin() + movers; m != part.info.movers.end(); ++m) {
    m->instance = uint32_t(std::ptrdiff_t(m->instance) - from + to);
  }
  part.info.materials = common.info.materials;
  part.info.names = common.info.names;
  part.info.class_names = common.info.class_names;
  return std::make_unique<TracedWorld>(std::move(part), world.matter());
}

TracedWorld::TracedWorld(const elements::Model& model, const Matter& matter)
    : matter_(resolved(matter, {&model, 1})),
      world_(std::make_unique<trace::World>(model, trace::Isa::kBest, draws_of(matter_))),
      dynamic_(std::make_unique<simulate::DynamicWorld>(*world_)),
      models_(&model, 1) {
  elements::SceneInfo info;
  info.class_names = model.class_names;
  kinds_ = simulate::instance_kinds({}, info);
  element_classes_ = elements::element_classes(info);
}

TracedWorld::TracedWorld(const elements::Scene& scene, const elements::SceneInfo& info,
                         const Matter& matter)
    : matter_(resolved(matter, scene.models)) {
  prepare(scene, info);
}

TracedWorld::TracedWorld(World world, const Matter& matter)
    : matter_(resolved(matter, world.scene.models)),
      own_(std::make_unique<World>(std::move(world))) {
  prepare(own_->scene, own_->info);
}

void TracedWorld::prepare(const elements::Scene& scene, const elements::SceneInfo& info) {
  const trace::Draws draws = draws_of(matter_);
  if (!info.movers.empty()) {
    dynamic_ = std::make_unique<simulate::DynamicWorld>(scene, info.movers, draws);
  } else {
    // A scene without instances is the world of its model, to the bit.
    world_ = scene.instances.empty()
                 ? std::make_unique<trace::World>(scene.models.at(0), trace::Isa::kBest, draws)
                 : std::make_unique<trace::World>(scene, trace::Isa::kBest, draws);
    dynamic_ = std::make_unique<simulate::DynamicWorld>(*world_);
  }
  models_ = scene.models;
  if (!scene.instances.empty()) scene_ = &scene;
  if (!scene.instances.empty()) labels_ = info.labels;
  kinds_ = simulate::instance_kinds(scene, info);
  materials_ = info.materials;
  for (const elements::Mover& m : info.movers) {
    const uint32_t model = scene.instances[m.instance].model;
    movers_.push_back({model < info.names.size() ? info.names[model] : "", m});
  }
  element_classes_ = elements::element_classes(info);
}

metrics::Bounds TracedWorld::bounds() const {
  if (!regions()) {
    return metrics::bounds_of(
        models_, scene_ ? std::span(scene_->instances) : std::span<const elements::Instance>());
  }
  metrics::Bounds all;
  for (const regions::Region& r : regions()->index().regions) {
    all.add(r.bounds.min());
    all.add(r.bounds.max());
  }
  return all;
}

std::optional<sensor::Sensor> TracedWorld::recorder() const {
  constexpr double kTypicalRange = 20;  // m; where the widths of several beams are compared
  const auto has_volumes = [](const elements::Model& m) {
    return m.whole_count(elements::Kind::kEllipsoid) > 0;
  };
  const bool volumes = std::any_of(models_.begin(), models_.end(), has_volumes);
  std::optional<sensor::Sensor> narrowest;
  for (const elements::Model& m : models_) {
    if (m.first_ellipsoid() == 0 && !has_volumes(m)) continue;
    if (volumes && !has_volumes(m)) continue;
    if (m.sensor.empty() || m.all_echoes) return std::nullopt;
    LogInfo info;
    info.sensor = m.sensor;
    info.sensor_file = m.sensor_file;
    sensor::Sensor s = sensor::sensor_of_log("model", info);
    s.range_sigma_m = std::min(s.range_sigma_m, m.range_noise_m);
    s.max_range_m = std::min(s.max_range_m, m.max_range_m);
    if (!narrowest || s.beam.sigma_m(kTypicalRange) < narrowest->beam.sigma_m(kTypicalRange)) {
      narrowest = std::move(s);
    }
  }
  return narrowest;
}

}  // namespace underbrush::pipeline
