/// \file
/// Scenes: models and where they stand.
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bind.hpp"
#include "given.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/world.hpp"
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

template <class T, class... Shape>
using Given = nb::ndarray<const T, nb::shape<Shape::value...>, nb::c_contig, nb::device::cpu>;
template <ssize_t n>
using Side = std::integral_constant<ssize_t, n>;

/// Makes a scene of copies of models. The arrays have a row for each instance; `classes` is empty
/// or has as many names, `names` and `materials` are empty or have one for each model.
SceneValue scene_of_models(const std::vector<const ModelValue*>& models,
                           const Given<uint32_t, Side<-1>>& model,
                           const Given<double, Side<-1>, Side<3>>& position,
                           const Given<double, Side<-1>, Side<4>>& rotation,
                           const Given<float, Side<-1>>& scale,
                           const std::vector<std::string>& classes, std::vector<std::string> names,
                           std::vector<std::string> materials) {
  const size_t n = model.shape(0);
  require(n > 0 && !models.empty(), "scene: no instances or no models");
  require(position.shape(0) == n && rotation.shape(0) == n && scale.shape(0) == n &&
              (classes.empty() || classes.size() == n),
          "scene: the columns are not of one length");
  require(names.empty() || names.size() == models.size(), "scene: one name a model is needed");
  require(materials.empty() || materials.size() == models.size(),
          "scene: one material a model is needed");
  SceneValue out;
  for (const ModelValue* m : models) out.scene.models.push_back(*m);
  for (size_t i = 0; i < n; ++i) {
    Instance placed;
    placed.model = model.data()[i];
    placed.scale = scale.data()[i];
    placed.world_from_model.translation = Eigen::Map<const Vec3>(position.data() + 3 * i);
    const Eigen::Map<const Eigen::Vector4d> xyzw(rotation.data() + 4 * i);
    require(std::abs(xyzw.norm() - 1) < 1e-6, "scene: a rotation is not a unit quaternion");
    placed.world_from_model.rotation = Eigen::Quaterniond(xyzw.normalized());
    out.scene.instances.push_back(placed);
    out.info.labels.push_back(classes.empty() ? elements::Class::kUnknown
                                              : elements::class_named(out.info, classes[i]));
  }
  out.scene.check();
  for (size_t k = names.size(); k < models.size(); ++k)
    names.push_back("model" + std::to_string(k));
  out.info.names = std::move(names);
  out.info.materials = std::move(materials);
  return out;
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
        if (elements::is_scene(path) || !worlds::is_world(path)) {
          v.scene = elements::read_scene(path, &v.info);
          return v;
        }
        pipeline::World world = pipeline::read_world(path);
        v.scene = std::move(world.scene);
        v.info = std::move(world.info);
        return v;
      },
      "path"_a, Released(),
      "Reads a scene's folder, or a mesh file (.obj, .ply, .gltf, .glb, .stl) as a scene whose\n"
      "instance 0 is empty. Raises `FormatError`.");
  m.def("scene_of_models", &scene_of_models, "models"_a, "model"_a, "position"_a, "rotation"_a,
        "scale"_a, "classes"_a, "names"_a, "materials"_a);
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
