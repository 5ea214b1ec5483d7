#include "underbrush/simulate/reflection.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::simulate {
namespace {

using elements::Class;
using elements::Kind;
using trace::Met;

/// Normal of a triangle, model frame.
Vec3 normal_of(const elements::Model& model, uint32_t element) {
  const bool ground = element < model.ground.size();
  const elements::TriangleMesh& mesh = ground ? model.ground : model.surface;
  const auto& corner = mesh.triangles[ground ? element : element - model.ground.size()];
  const Vec3 a = mesh.vertices[corner[0]].cast<double>();
  const Vec3 b = mesh.vertices[corner[1]].cast<double>();
  const Vec3 c = mesh.vertices[corner[2]].cast<double>();
  return (b - a).cross(c - a).normalized();
}

}  // namespace

Reflection::Reflection(const radiometry::Materials& materials, double wavelength_m,
                       const InstanceKinds& kinds)
    : label_(kinds.label) {
  const auto index = [&](const radiometry::Material& m) {
    return size_t(&m - materials.material.data());
  };
  require(materials.material.size() <= 256, "reflection: more than 256 materials");
  for (const radiometry::Material& m : materials.material) {
    // Lambert and Oren–Nayar are both a cos θ + b sin² θ.
    const double a = radiometry::backscatter(m.surface, 1);
    const double b = (radiometry::backscatter(m.surface, 0.5) - 0.5 * a) / 0.75;
    coats_.push_back(
        {m.reflectance_at(wavelength_m), a, b, m.surface, radiometry::Foliage(m.leaf_shape)});
  }
  for (const std::string_view name : elements::kClassNames) {
    of_class_.push_back(uint8_t(index(materials.of(name))));
  }
  for (const std::string& name : kinds.material) {
    of_instance_.push_back(name.empty() ? -1 : int(index(materials.named(name))));
  }
}

uint8_t Reflection::coat_of(const Surroundings& s, const Met& met, Kind kind) const {
  if (met.instance < of_instance_.size() && of_instance_[met.instance] >= 0) {
    return uint8_t(of_instance_[met.instance]);
  }
  if (kind == Kind::kGround) return of_class_[size_t(Class::kGround)];
  if (met.instance < label_.size() && label_[met.instance] != Class::kUnknown &&
      label_[met.instance] != Class::kGround) {
    return of_class_[size_t(label_[met.instance])];
  }
  if (kind == Kind::kSurface) return of_class_[size_t(Class::kUnknown)];
  const elements::Model& model = s.model(met.instance);
  const uint32_t label =
      model.ellipsoids[met.element - model.ground.size() - model.surface.size()].label;
  return of_class_[label < of_class_.size() ? label : 0];
}

Reflection::Asker::Asker(const Reflection& reflection, const Surroundings& surroundings)
    : reflection_(reflection),
      surroundings_(surroundings),
      leaves_(reflection.coats_.size(), -1) {}

void Reflection::Asker::begin(const Vec3& axis, double time_s) {
  cos_zenith_ = axis.z();
  std::fill(leaves_.begin(), leaves_.end(), -1.0F);
  if (surroundings_.moves()) last_ = {};  // it may have turned
  time_s_ = time_s;
}

void Reflection::Asker::see_triangle(const Met& met) {
  const elements::Model& model = surroundings_.model(met.instance);
  const Vec3 normal = normal_of(model, met.element);
  normal_ = surroundings_.placed(met.instance, time_s_).world_from_model.rotation * normal;
  coat_ = &reflection_.coats_[reflection_.coat_of(surroundings_, met, model.kind(met.element))];
  last_ = met;
}

float Reflection::Asker::factor(const Met& met, const Vec3& direction) {
  const bool same = met.element == last_.element && met.instance == last_.instance;
  if (!same) {
    const elements::Model& model = surroundings_.model(met.instance);
    if (model.kind(met.element) == Kind::kEllipsoid) {
      const uint8_t k = reflection_.coat_of(surroundings_, met, Kind::kEllipsoid);
      if (leaves_[k] < 0) {
        const Coat& coat = reflection_.coats_[k];
        leaves_[k] = float(coat.reflectance * coat.foliage.backscatter(cos_zenith_));
      }
      return leaves_[k];
    }
    see_triangle(met);
  }
  const Coat& coat = *coat_;
  const double c = std::min(1.0, std::abs(normal_.dot(direction)));
  if (coat.surface.brdf == radiometry::Brdf::kPhong) {
    return float(coat.reflectance * radiometry::backscatter(coat.surface, c));
  }
  return float(coat.reflectance * (coat.a * c + coat.b * (1 - c * c)));
}

}  // namespace underbrush::simulate
