#include "underbrush/simulate/reflection.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::simulate {
namespace {

using elements::Class;
using trace::Intersection;

/// Computes the normal of a triangle in the model frame.
Vec3 normal_of(const elements::Model& model, uint32_t element) {
  const elements::ElementPlace at = model.place(element);
  const elements::TriangleMesh& mesh = model.mesh(at.kind);
  const auto& corner = mesh.triangles[at.index];
  const Vec3 a = mesh.vertices[corner[0]].cast<double>();
  const Vec3 b = mesh.vertices[corner[1]].cast<double>();
  const Vec3 c = mesh.vertices[corner[2]].cast<double>();
  return (b - a).cross(c - a).normalized();
}

/// Finds the material of a class that a scene has of its own.
const radiometry::Material& of_own_class(const radiometry::Materials& materials,
                                         const std::string& name) {
  for (const auto& [label, material] : materials.of_class) {
    if (label == name) return materials.named(material);
  }
  for (const radiometry::Material& m : materials.material) {
    if (m.name == name) return m;
  }
  return materials.of("unknown");
}

}  // namespace

InstanceKinds instance_kinds(const elements::Scene& scene, const elements::SceneInfo& info) {
  InstanceKinds kinds;
  kinds.label = info.labels;
  kinds.class_names = info.class_names;
  for (const elements::SceneMaterial& own : info.own_materials) {
    radiometry::Material m;
    m.name = own.name;
    m.reflectance = own.reflectance;
    kinds.own_materials.push_back(std::move(m));
  }
  if (info.materials.empty()) return kinds;
  for (const elements::Instance& i : scene.instances) {
    kinds.material.push_back(info.materials[i.model]);
  }
  return kinds;
}

radiometry::Materials with_own_materials(radiometry::Materials table, const InstanceKinds& kinds,
                                         bool replaces) {
  for (const radiometry::Material& own : kinds.own_materials) {
    const auto same = [&](const radiometry::Material& other) { return other.name == own.name; };
    const auto at = std::find_if(table.material.begin(), table.material.end(), same);
    if (at == table.material.end()) {
      table.material.push_back(own);
    } else if (replaces) {
      *at = own;
    }
  }
  return table;
}

Reflection::Reflection(const radiometry::Materials& materials, double wavelength_m,
                       const InstanceKinds& kinds)
    : label_(kinds.label) {
  const auto index = [&](const radiometry::Material& m) {
    return size_t(&m - materials.material.data());
  };
  require(materials.material.size() <= 256, "reflection: more than 256 materials");
  for (const radiometry::Material& m : materials.material) {
    // Lambert and Oren–Nayar both have the form a cos θ + b sin² θ.
    const double a = radiometry::backscatter(m.surface, 1);
    const double b = (radiometry::backscatter(m.surface, 0.5) - 0.5 * a) / 0.75;
    materials_.push_back(
        {m.reflectance_at(wavelength_m), a, b, m.surface, LeafAngleDistribution(m.leaf_shape)});
  }
  for (const std::string_view name : elements::kClassNames) {
    of_class_.push_back(uint8_t(index(materials.of(name))));
  }
  for (const std::string& name : kinds.class_names) {
    of_class_.push_back(uint8_t(index(of_own_class(materials, name))));
  }
  for (const std::string& name : kinds.material) {
    of_instance_.push_back(name.empty() ? -1 : int(index(materials.named(name))));
  }
}

int Reflection::material_of(uint32_t instance) const {
  if (instance < of_instance_.size() && of_instance_[instance] >= 0) return of_instance_[instance];
  if (instance >= label_.size()) return -1;
  const Class label = label_[instance];
  return label == Class::kUnknown || label == Class::kGround ? -1 : of_class_[size_t(label)];
}

Reflection::Evaluator::Evaluator(const Reflection& reflection, const DynamicWorld& world)
    : reflection_(reflection),
      world_(world),
      triangles_(kRemembered),
      leaves_(reflection.materials_.size(), -1) {}

void Reflection::Evaluator::begin(const Vec3& axis, double time_s) {
  if (world_.moves() && time_s != time_s_) {
    triangles_.assign(kRemembered, {});
    instance_ = Intersection::kNone;
  }
  axis_ = axis;
  time_s_ = time_s;
  set_zenith();
}

void Reflection::Evaluator::set_zenith() {
  const double c = up_.dot(axis_);
  if (c != cos_zenith_) std::fill(leaves_.begin(), leaves_.end(), -1.0F);
  cos_zenith_ = c;
}

void Reflection::Evaluator::enter(uint32_t instance) {
  instance_ = instance;
  model_ = &world_.model(instance);
  first_ellipsoid_ = uint32_t(model_->first_ellipsoid());
  material_ = reflection_.material_of(instance);
  up_ = world_.placed(instance, time_s_).world_from_model.rotation * Vec3::UnitZ();
  set_zenith();
}

void Reflection::Evaluator::remember(const Intersection& met, Triangle& t) {
  t.instance = met.instance;
  t.element = met.element;
  const Pose world_from_model = world_.placed(met.instance, time_s_).world_from_model;
  t.normal = world_from_model.rotation * normal_of(*model_, met.element);
  const bool ground = model_->kind(met.element) == elements::Kind::kGround;
  const bool named =
      !reflection_.of_instance_.empty() && reflection_.of_instance_[met.instance] >= 0;
  const Class label = ground ? Class::kGround : Class::kUnknown;
  const bool own = material_ >= 0 && (!ground || named);
  t.material =
      &reflection_.materials_[own ? size_t(material_) : reflection_.of_class_[size_t(label)]];
}

float Reflection::Evaluator::leaves(size_t material) {
  const Material& c = reflection_.materials_[material];
  return leaves_[material] = float(c.reflectance * c.leaf_angles.backscatter(cos_zenith_));
}

void Reflection::Evaluator::factors(std::span<const Intersection> met, std::span<const Ray> rays,
                                    std::span<const uint32_t> sub_ray, std::span<float> factor) {
  const auto& of_class = reflection_.of_class_;
  for (size_t k = 0; k < sub_ray.size(); ++k) {
    const Intersection& m = met[sub_ray[k]];
    if (m.instance != instance_) enter(m.instance);
    if (m.element >= first_ellipsoid_) {
      size_t material = size_t(material_);
      if (material_ < 0) {
        const uint32_t label = m.element == trace::kUnknown
                                   ? 0
                                   : model_->ellipsoids[model_->place(m.element).index].label;
        material = of_class[label < of_class.size() ? label : 0];
      }
      factor[k] = leaves_[material] < 0 ? leaves(material) : leaves_[material];
      continue;
    }
    Triangle& t = triangles_[(m.element + 97 * m.instance) % kRemembered];
    if (t.element != m.element || t.instance != m.instance) remember(m, t);
    const Material& material = *t.material;
    const double c = std::min(1.0, std::abs(t.normal.dot(rays[sub_ray[k]].direction)));
    factor[k] = material.surface.brdf == radiometry::Brdf::kPhong
                    ? float(material.reflectance * radiometry::backscatter(material.surface, c))
                    : float(material.reflectance * (material.a * c + material.b * (1 - c * c)));
  }
}

}  // namespace underbrush::simulate
