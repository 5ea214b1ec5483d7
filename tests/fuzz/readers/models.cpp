// The readers of models, scenes, sensors, lists of objects and worlds.
#include "fuzz/readers/reader.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/training_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/optimize/checkpoint.hpp"
#include "underbrush/perception/object_list_file.hpp"
#include "underbrush/perception/rig.hpp"
#include "underbrush/perception/truth.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/given_labels.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/worlds/helios_survey.hpp"
#include "underbrush/worlds/read_world.hpp"
#include "underbrush/worlds/voxel_file.hpp"

namespace underbrush::fuzz {
namespace {

void read_model_of(const Path& path) { elements::read_model(path.parent_path()); }

void read_scene_of(const Path&) {
  elements::SceneInfo info;
  elements::read_scene("moving", &info);
}

void read_primitives(const Path&) {
  const primitives::PrimitiveSet set = primitives::read_primitive_set("primitives");
  for (size_t k = 0; k < set.entries.size(); ++k) primitives::read_primitive(set, k);
}

void read_labels(const Path& path) {
  static const BeamLog log = io::read_log("log.ply");
  MemorySource source(log);
  primitives::GivenLabelOptions options;
  options.set = "semantickitti";
  primitives::read_given_labels(path, source, options);
}

void read_survey(const Path&) { worlds::read_helios_survey("survey.xml", {}); }
void read_world(const Path& path) { worlds::read_world(path); }

const Reader kReaders[] = {
    {"model", "model/model.json", read_model_of},
    {"model-keyframes", "remembering/model.json", read_model_of},
    {"ground", "mesh/ground.ply model/ground.ply", read_model_of},
    {"surface", "mesh/surface.ply", read_model_of},
    {"ellipsoids", "model/ellipsoids.ply", read_model_of},
    {"observed-space", "model/observed_space.ply", read_model_of},
    {"keyframes", "remembering/keyframes.ply", read_model_of},
    {"training", "model/training/training.json", [](const Path&) { fit::read_training("model"); }},
    {"tiles", "model/training/tiles.ply", [](const Path&) { fit::read_training("model"); }},
    {"residuals", "model/training/residuals.ply", [](const Path&) { fit::read_training("model"); }},
    {"sums", "model/training/ground.ply", [](const Path&) { fit::read_training("model"); }},
    {"scene", "moving/scene.json", read_scene_of},
    {"instances", "moving/instances.ply", read_scene_of},
    {"movers", "moving/movers/0000.txt", read_scene_of},
    {"annotation", "site.json moving.json",
     [](const Path& path) { primitives::read_annotation(path); }},
    {"primitives", "primitives/primitives.json", read_primitives},
    {"label-file", "cloud.label", read_labels},
    {"label-table", "label.csv", read_labels},
    {"checkpoint", "state.json", [](const Path& path) { optimize::read_checkpoint(path); }},
    {"objects-csv", "objects.csv", [](const Path& path) { perception::read_object_lists(path); }},
    {"objects-json", "objects.json", [](const Path& path) { perception::read_object_lists(path); }},
    {"boxes", "boxes.csv", [](const Path& path) { perception::read_labelled_boxes(path); }},
    {"rig", "rig.yaml", [](const Path& path) { perception::load_rig(path.string()); }},
    {"sensor", "spinning.yaml raster.yaml table.yaml",
     [](const Path& path) { sensor::load(path.string()); }},
    {"directions", "table.csv", [](const Path&) { sensor::load("table.yaml"); }},
    {"materials", "materials.yaml",
     [](const Path& path) { radiometry::load_materials(path.string()); }},
    {"voxels", "forest.vox", read_world},
    {"helios-scene", "world.xml", read_world},
    {"helios-survey", "survey.xml", read_survey},
    {"helios-scanner", "scanners.xml", read_survey},
    {"helios-platform", "platforms.xml", read_survey},
    {"helios-path", "flight.trj", read_survey},
};

}  // namespace

std::span<const Reader> readers() { return kReaders; }
void make_seeds() {}

}  // namespace underbrush::fuzz
