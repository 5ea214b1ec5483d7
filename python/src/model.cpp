/// \file
/// Models, and the tables of their elements.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>

#include "arrow_tables.hpp"
#include "bind.hpp"
#include "given.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "views.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using elements::Ellipsoid;
using elements::HitCount;
using elements::TriangleMesh;
using Released = nb::call_guard<nb::gil_scoped_release>;
using MeshSelf = nb::handle_t<TriangleMesh>;
using ModelSelf = nb::handle_t<ModelValue>;

/// The ellipsoids of a model, as a table.
struct EllipsoidTable {
  const std::vector<Ellipsoid>* rows;
};
using TableSelf = nb::handle_t<EllipsoidTable>;

const TriangleMesh& mesh_of(const MeshSelf& s) { return *nb::inst_ptr<TriangleMesh>(s); }
const std::vector<Ellipsoid>& table_of(const TableSelf& s) {
  return *nb::inst_ptr<EllipsoidTable>(s)->rows;
}

template <class T>
auto mesh_hit(MeshSelf s, T HitCount::*member) {
  return view_member(
      mesh_of(s).hit, [member](const HitCount& h) { return &(h.*member); }, s);
}

void bind_mesh(nb::module_& m) {
  nb::class_<TriangleMesh>(
      m, "TriangleMesh",
      "Triangles, each with a hit probability; all arrays are views that cannot be\n"
      "written.")
      .def("__len__", &TriangleMesh::size)
      .def_prop_ro(
          "vertices", [](MeshSelf s) { return view_rows<const float, 3>(mesh_of(s).vertices, s); },
          "View (v, 3) float32, m, relative to the model's origin.")
      .def_prop_ro(
          "triangles",
          [](MeshSelf s) { return view_rows<const uint32_t, 3>(mesh_of(s).triangles, s); },
          "View (n, 3) uint32: indices into `vertices`.")
      .def_prop_ro(
          "hit_probability", [](MeshSelf s) { return mesh_hit(s, &HitCount::p); },
          "View (n,) float32.")
      .def_prop_ro(
          "hits", [](MeshSelf s) { return mesh_hit(s, &HitCount::hits); },
          "View (n,) uint32: beams that met the triangle and ended at it.")
      .def_prop_ro(
          "misses", [](MeshSelf s) { return mesh_hit(s, &HitCount::misses); },
          "View (n,) uint32: beams that met the triangle and went on.")
      .def_ro("range_sigma_m", &TriangleMesh::range_sigma_m,
              "m; standard deviation of the range about the surface.")
      .def_ro("roughness_m", &TriangleMesh::roughness_m,
              "m; standard deviation, along the normal, of the surface about the mesh.")
      .def_prop_ro(
          "roughness",
          [](MeshSelf s) {
            return view_member(
                mesh_of(s).roughness, [](const float& h) { return &h; }, s);
          },
          "View (n,) float32, m: the same of each triangle; empty where all have `roughness_m`.");
}

template <class T>
auto ellipsoid_member(TableSelf s, T Ellipsoid::*member) {
  return view_member(
      table_of(s), [member](const Ellipsoid& e) { return &(e.*member); }, s);
}

template <class T>
auto ellipsoid_hit(TableSelf s, T HitCount::*member) {
  return view_member(
      table_of(s), [member](const Ellipsoid& e) { return &(e.hit.*member); }, s);
}

void bind_ellipsoids(nb::module_& m) {
  nb::class_<EllipsoidTable>(
      m, "EllipsoidTable",
      "The permeable ellipsoids (mean, covariance, p) of a model; all arrays are\n"
      "views that cannot be written.")
      .def("__len__", [](const EllipsoidTable& t) { return t.rows->size(); })
      .def_prop_ro(
          "mean",
          [](TableSelf s) {
            return view_member_rows<3>(
                table_of(s), [](const Ellipsoid& e) { return e.mean.data(); }, s);
          },
          "View (n, 3) float32, m, relative to the model's origin.")
      .def_prop_ro(
          "covariance",
          [](TableSelf s) {
            return view_member_rows<6>(
                table_of(s), [](const Ellipsoid& e) { return e.covariance.data(); }, s);
          },
          "View (n, 6) float32, m^2: xx xy xz yy yz zz.")
      .def_prop_ro(
          "hit_probability", [](TableSelf s) { return ellipsoid_hit(s, &HitCount::p); },
          "View (n,) float32.")
      .def_prop_ro(
          "hits", [](TableSelf s) { return ellipsoid_hit(s, &HitCount::hits); },
          "View (n,) uint32: beams that met the ellipsoid and ended at it.")
      .def_prop_ro(
          "misses", [](TableSelf s) { return ellipsoid_hit(s, &HitCount::misses); },
          "View (n,) uint32: beams that met the ellipsoid and went on.")
      .def_prop_ro(
          "label", [](TableSelf s) { return ellipsoid_member(s, &Ellipsoid::label); },
          "View (n,) uint32: class of the points that it was fitted to; 0 = unknown.")
      .def_prop_ro(
          "density_per_m",
          [](TableSelf s) { return ellipsoid_member(s, &Ellipsoid::density_per_m); },
          "View (n,) float32, 1/m: where positive, it stands for the hit probability.");
}

}  // namespace

// long: a list of members.
void bind_model(nb::module_& m) {
  bind_mesh(m);
  bind_ellipsoids(m);
  nb::class_<ModelValue> c(
      m, "Model",
      "A learnt world: ground and surface triangles and permeable ellipsoids. Elements are "
      "numbered\n"
      "in this order. Coordinates are relative to `origin` (world, m). A model does not change.\n"
      "Libraries that read Arrow's tables take a model for one, with a row for each element: "
      "`kind` (0\n"
      "ground, 1 surface, 2 ellipsoid), `centre` (m, world), `covariance` (m^2, of ellipsoids), "
      "the\n"
      "hits, and the label and density of ellipsoids.");
  c.def(
       "__len__", [](const ModelValue& v) { return v.size(); }, "Number of elements.")
      .def_prop_ro(
          "origin", [](const ModelValue& v) { return v.origin; }, "(3,), m, world; a copy.")
      .def_prop_ro(
          "ground", [](ModelValue& v) { return &v.ground; }, nb::rv_policy::reference_internal,
          "Triangles of the ground.")
      .def_prop_ro(
          "surface", [](ModelValue& v) { return &v.surface; }, nb::rv_policy::reference_internal,
          "Triangles that are not ground.")
      .def_prop_ro(
          "ellipsoids", [](const ModelValue& v) { return EllipsoidTable{&v.ellipsoids}; },
          nb::keep_alive<0, 1>(), "The ellipsoids.")
      .def_prop_ro(
          "tau", [](const ModelValue& v) { return v.tau; },
          "A beam meets an ellipsoid within this Mahalanobis distance.")
      .def_prop_ro(
          "range_noise_m", [](const ModelValue& v) { return v.range_noise_m; },
          "m; the sensor's part of the standard deviation of a range.")
      .def_prop_ro(
          "leaf_shape", [](const ModelValue& v) { return v.leaf_angles.shape(); },
          "Shape of the distribution of leaf angles; 1 is spherical, more is flatter [campbell86].")
      .def_prop_ro(
          "sway_s", [](const ModelValue& v) { return v.sway_s; },
          "s; correlation time of the ellipsoids' matter; 0 where it stands still.")
      .def_prop_ro(
          "max_range_m", [](const ModelValue& v) { return v.max_range_m; },
          "m; largest range of a return in the log that it was fitted to.")
      .def_prop_ro(
          "fitter", [](const ModelValue& v) { return v.fitter; },
          "Name of the fitter that made the model.")
      .def_prop_ro(
          "provenance", [](const ModelValue& v) { return v.provenance; },
          "How the model was made: program, command, seed and inputs, as JSON.")
      .def_prop_ro(
          "report_json", [](const ModelValue& v) { return v.report; },
          "What `report_of` reads: counts and warnings of the fit, as JSON.")
      .def("__repr__", [](const ModelValue& v) {
        return "Model(" + v.fitter + ": " + std::to_string(v.ground.size()) + " ground and " +
               std::to_string(v.surface.size()) + " surface triangles, " +
               std::to_string(v.ellipsoids.size()) + " ellipsoids)";
      });
  bind_arrow(c, [](ModelSelf self) { return table_of(*nb::inst_ptr<ModelValue>(self)); });
  m.def(
      "read_model",
      [](const std::filesystem::path& path) {
        pipeline::TrainedModel read = pipeline::read_trained(path);
        return ModelValue{std::move(read.model), std::move(read.training)};
      },
      "path"_a, Released(), "Reads a model's folder. Raises `FormatError`.");
  m.def(
      "write_model",
      [](const std::filesystem::path& path, const ModelValue& v) {
        pipeline::write_trained(path, {v, v.training, {}, 0});
      },
      "path"_a, "model"_a, Released(),
      "Writes the folder of a model, whole or not at all; a model that stood there is replaced.\n"
      "Raises `OSError`, also if a folder that is not a model stands there.");
}

}  // namespace underbrush::python
