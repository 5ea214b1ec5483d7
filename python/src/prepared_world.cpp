#include "prepared_world.hpp"

#include "underbrush/io/poses.hpp"
#include "underbrush/live/open_world.hpp"

namespace underbrush::python {
namespace {

/// Returns a world of one's own, or nothing where a value can be traced as it is.
std::optional<pipeline::World> own_world(const GivenWorld& given, const SimulateOptions& options) {
  if (const auto* path = std::get_if<std::filesystem::path>(&given)) {
    return pipeline::open_world(*path, options.read);
  }
  if (options.movers.empty() && options.absent.empty() &&
      !pipeline::changes_world(options.pipeline)) {
    return std::nullopt;
  }
  pipeline::World own;
  if (const auto* model = std::get_if<const ModelValue*>(&given)) {
    own.scene.models.push_back(**model);
    own.info.class_names = (*model)->class_names;
  } else {
    const SceneValue& scene = *std::get<const SceneValue*>(given);
    own.scene = scene.scene;
    own.info = scene.info;
  }
  return own;
}

elements::Model mover_of(const GivenModel& given) {
  if (const auto* model = std::get_if<const ModelValue*>(&given)) return **model;
  return actors::read_mover(std::get<std::filesystem::path>(given));
}

void add_mover(pipeline::World& world, const GivenMover& mover) {
  const auto& [moved, poses, material] = mover;
  const auto* poses_file = std::get_if<std::filesystem::path>(&poses);
  pipeline::add_mover(world, mover_of(moved),
                      poses_file ? io::read_trajectory(*poses_file) : std::get<Trajectory>(poses),
                      material);
}

}  // namespace

PreparedWorld::PreparedWorld(const GivenWorld& given, const SimulateOptions& options) {
  const pipeline::Matter matter = pipeline::matter_of(options.pipeline);
  if (std::optional<pipeline::World> own = own_world(given, options)) {
    for (const GivenMover& mover : options.movers) add_mover(*own, mover);
    for (const auto& [name, model] : options.absent) live::add_absent(*own, name, mover_of(model));
    pipeline::change_world(*own, options.pipeline);
    traced_ = std::make_unique<pipeline::TracedWorld>(std::move(*own), matter);
  } else if (const auto* model = std::get_if<const ModelValue*>(&given)) {
    traced_ = std::make_unique<pipeline::TracedWorld>(**model, matter);
  } else {
    const SceneValue& scene = *std::get<const SceneValue*>(given);
    traced_ = std::make_unique<pipeline::TracedWorld>(scene.scene, scene.info, matter);
  }
}

}  // namespace underbrush::python
