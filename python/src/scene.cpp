/// \file
/// Scenes: models and where they stand.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bind.hpp"
#include "given.hpp"
#include "stages.hpp"
#include "views.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using elements::Instance;
using Path = std::filesystem::path;
using Released = nb::call_guard<nb::gil_scoped_release>;
using SceneSelf = nb::handle_t<SceneValue>;

const SceneValue& scene_of(const SceneSelf& s) { return *nb::inst_ptr<SceneValue>(s); }

std::vector<std::string> class_names() {
  return {elements::kClassNames.begin(), elements::kClassNames.end()};
}

ModelValue model_at(const SceneValue& v, size_t index) {
  if (index >= v.scene.models.size()) throw nb::index_error("scene: no such model");
  return ModelValue{v.scene.models[index]};
}

// long: the table of what a scene shows
void bind_values(nb::module_& m) {
  nb::class_<SceneValue>(
      m, "Scene",
      "Models and where they stand in the world: x_world = position + scale * R x, with x "
      "relative\n"
      "to the model's origin. Instance 0 of a composed scene is its ground. The arrays are views\n"
      "that cannot be written; a scene does not change.")
      .def(
          "__len__", [](const SceneValue& v) { return v.scene.instances.size(); },
          "Number of instances.")
      .def_prop_ro(
          "position",
          [](SceneSelf s) {
            return view_member_rows<3>(
                scene_of(s).scene.instances,
                [](const Instance& i) { return i.world_from_model.translation.data(); }, s);
          },
          "View (n, 3) float64, m, world.")
      .def_prop_ro(
          "rotation",
          [](SceneSelf s) {
            return view_member_rows<4>(
                scene_of(s).scene.instances,
                [](const Instance& i) { return i.world_from_model.rotation.coeffs().data(); }, s);
          },
          "View (n, 4) float64: unit quaternions x y z w, world from model.")
      .def_prop_ro(
          "scale",
          [](SceneSelf s) {
            return view_member(
                scene_of(s).scene.instances, [](const Instance& i) { return &i.scale; }, s);
          },
          "View (n,) float32.")
      .def_prop_ro(
          "model",
          [](SceneSelf s) {
            return view_member(
                scene_of(s).scene.instances, [](const Instance& i) { return &i.model; }, s);
          },
          "View (n,) uint32: number of each instance's model.")
      .def_prop_ro(
          "label",
          [](SceneSelf s) {
            const auto& labels = scene_of(s).info.labels;
            return Column<const uint8_t>(reinterpret_cast<const uint8_t*>(labels.data()),
                                         {labels.size()}, s);
          },
          "View (n,) uint8: class of each instance, an index into `class_names()` followed by the\n"
          "scene's own `classes`.")
      .def_prop_ro(
          "classes", [](const SceneValue& v) { return v.info.class_names; },
          "Names of the classes that the scene has besides `class_names()`.")
      .def_prop_ro(
          "models", [](const SceneValue& v) { return v.scene.models.size(); }, "Number of models.")
      .def("copy_model", &model_at, "index"_a, Released(),
           "Returns a copy of a model. Raises `IndexError`.")
      .def_prop_ro(
          "names", [](const SceneValue& v) { return v.info.names; }, "One for each model.")
      .def_prop_ro(
          "materials", [](const SceneValue& v) { return v.info.materials; },
          "One for each model; \"\" where its class decides.")
      .def_prop_ro(
          "movers", [](const SceneValue& v) { return v.info.movers.size(); },
          "Number of instances that move.")
      .def_prop_ro(
          "provenance", [](const SceneValue& v) { return v.info.provenance; },
          "How the scene was made: program, command, seed and inputs, as JSON.")
      .def_prop_ro(
          "report_json", [](const SceneValue& v) { return v.report; },
          "What `report_of` reads: counts of the composition, as JSON.")
      .def("__repr__", [](const SceneValue& v) {
        return "Scene(" + std::to_string(v.scene.instances.size()) + " instances of " +
               std::to_string(v.scene.models.size()) + " models)";
      });
}

}  // namespace

void bind_scene(nb::module_& m) {
  bind_values(m);
  m.def(
      "read_scene",
      [](const Path& path) {
        SceneValue v;
        v.scene = elements::is_scene(path) || !worlds::is_world(path)
                      ? elements::read_scene(path, &v.info)
                      : app::read_world(path, &v.info);
        return v;
      },
      "path"_a, Released(),
      "Reads a scene's folder, or a mesh file (.obj, .ply, .gltf, .glb, .stl) as a scene whose\n"
      "instance 0 is empty. Raises `FormatError`.");
  m.def(
      "write_scene",
      [](const Path& path, const SceneValue& v) { elements::write_scene(path, v.scene, v.info); },
      "path"_a, "scene"_a, Released(),
      "Writes the folder of a scene, whole or not at all; a scene that stood there is replaced.\n"
      "Raises `OSError`, also if a folder that is not a scene stands there.");
  m.def("is_scene", &elements::is_scene, "path"_a, "Whether a path is the folder of a scene.");
  m.def("class_names", &class_names, "Returns the names of the classes; the index is the number.");
}

}  // namespace underbrush::python
