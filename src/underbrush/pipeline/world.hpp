/// \file
/// This file has the worlds that beams are fired into: models, scenes and worlds of other programs,
/// read, changed by options and prepared for tracing.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/actors/actor.hpp"
#include "underbrush/core/pose.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/metrics/bounds.hpp"
#include "underbrush/regions/world_folder.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/simulate/dynamic_world.hpp"
#include "underbrush/simulate/reflection.hpp"
#include "underbrush/worlds/read_world.hpp"

namespace underbrush {
/// The verbs as functions: values in, values out. Every face of Underbrush (the program, Python,
/// the server, the FMU, the studies) calls them, so that all give one answer.
namespace pipeline {

/// A scene, or a model as a scene without instances, with the other data of its folder.
struct World {
  elements::Scene scene;
  elements::SceneInfo info;
  worlds::WorldReport read;  ///< Report on a file of another program; no parts for all others.
  /// The world of regions of which `scene` has the part that all regions have in common; null where
  /// `scene` has all.
  std::shared_ptr<const regions::WorldFolder> regions = nullptr;
};

/// Reads a scene, a model, all of a world of regions, or a world of another program such as a mesh.
/// Throws as the readers do.
World read_world(const std::filesystem::path& path, const worlds::ReadOptions& options = {});
/// Does so too, but leaves the regions of a world on disk, for `Simulation` to open.
World open_world(const std::filesystem::path& path, const worlds::ReadOptions& options = {});

/// Reads a model for its ground. Throws `FormatError`, also where it has none.
elements::Model read_ground(const std::filesystem::path& path);
/// Adds an object that moves along `world_from_object`. A world of one model becomes a scene of one
/// instance before. In a world of regions it belongs to no region. `material` is "" for that of the
/// object's class.
void add_mover(World& world, elements::Model model, Trajectory world_from_object,
               const std::string& material, const std::string& name = "");
/// Adds actors with their names. Their matter sways as that of the world does, because all matter
/// of a world is drawn alike.
void add_actors(World& world, std::vector<actors::Actor> actors);

/// Whether and how the matter of a world is drawn for all beams at once (`trace::Draws`).
struct Matter {
  bool anew = false;   ///< Each beam draws its own leaves and stones.
  bool still = false;  ///< Matter stands still, also where that of the models sways.
  double sway_s = 0;   ///< s; correlation time of swaying matter; 0 = that of the models.
};

/// A moving object in a world.
struct NamedMover {
  std::string name;  ///< The name of its model; may be "".
  elements::Mover mover;
};

/// A world prepared for tracing.
class TracedWorld {
 public:
  /// Arguments by reference must outlive this. Throws `std::invalid_argument` where matter that is
  /// drawn anew should sway, and as `DynamicWorld` does.
  explicit TracedWorld(const elements::Model& model, const Matter& matter = {});
  TracedWorld(const elements::Scene& scene, const elements::SceneInfo& info,
              const Matter& matter = {});
  explicit TracedWorld(World world, const Matter& matter = {});
  TracedWorld(const TracedWorld&) = delete;
  TracedWorld& operator=(const TracedWorld&) = delete;

  /// Gives a mover another trajectory and other times (`DynamicWorld::move`).
  void move(const elements::Mover& mover) { dynamic_->move(mover); }
  /// The movers, with their motions from when the world was made.
  const std::vector<NamedMover>& movers() const { return movers_; }
  const simulate::DynamicWorld& dynamic() const { return *dynamic_; }
  /// The world that this owns; null where it was passed by reference.
  const World* own() const { return own_.get(); }
  /// The world of regions that this has the common part of; null where it has all.
  const regions::WorldFolder* regions() const { return own_ ? own_->regions.get() : nullptr; }
  const Matter& matter() const { return matter_; }
  /// The box in which the world lies; of a world of regions, the box of all that rays can meet.
  metrics::Bounds bounds() const;
  /// The world without its movers.
  const trace::World& still() const { return dynamic_->world(); }
  std::span<const elements::Model> models() const { return models_; }
  /// The scene; null for a world of one model.
  const elements::Scene* scene() const { return scene_; }
  /// The class of each instance; empty for a world of one model.
  const std::vector<elements::Class>& labels() const { return labels_; }
  const simulate::InstanceKinds& kinds() const { return kinds_; }
  /// s; the correlation time of its matter; 0 where matter stands still or is drawn anew.
  double sway_s() const { return matter_.sway_s; }
  /// The names of the materials that the models name.
  const std::vector<std::string>& materials() const { return materials_; }
  /// The names of the numbers of the column `element_class`; none where they are those of
  /// `elements::Class`.
  const std::vector<std::string>& element_classes() const { return element_classes_; }
  /// The sensor that recorded the logs to which the models were fitted, with the range noise and
  /// the farthest range that they showed; of several that with the narrowest beam. There is none
  /// where a model with ellipsoids (or any, if none has) does not name its own, or has shares of
  /// the light (`Model::all_echoes`).
  std::optional<sensor::Sensor> recorder() const;

 private:
  void prepare(const elements::Scene& scene, const elements::SceneInfo& info);

  Matter matter_;
  std::unique_ptr<World> own_;
  std::unique_ptr<trace::World> world_;
  std::unique_ptr<simulate::DynamicWorld> dynamic_;
  const elements::Scene* scene_ = nullptr;
  std::span<const elements::Model> models_;
  std::vector<elements::Class> labels_;
  simulate::InstanceKinds kinds_;
  std::vector<std::string> materials_, element_classes_;
  std::vector<NamedMover> movers_;
};

/// Reads regions of the world of regions of `world`, and prepares its part with them and with the
/// movers that were added to `world`. Its models have the τ and the grain of those of `world`.
/// Throws `FormatError`.
std::unique_ptr<TracedWorld> open_part(const TracedWorld& world, std::span<const uint32_t> regions);

}  // namespace pipeline
}  // namespace underbrush
