#include "underbrush/simulate/learnt_light.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/elements/element_light.hpp"

namespace underbrush::simulate {

void LearntLight::set(const elements::Model& model) {
  if (model_ == &model) return;
  model_ = &model;
  same_sensor_ = model.sensor == sensor_ && model.sensor_file == sensor_file_;
}

float LearntLight::answer(const elements::MeanReflectance& of, double cosine, bool is_ellipsoid,
                          uint32_t element, double range_m, uint16_t ring, uint64_t key) const {
  double x = of.mean;
  if (draw_ == IntensityDraw::kDrawn) {
    const double relative = of.spread / of.mean;
    const double variance = std::log1p(relative * relative);  // of ln x
    const double n = normal(key, element, Purpose::kSignal);
    x *= std::exp(std::sqrt(variance) * n - 0.5 * variance);
  }
  const elements::Light& light = model_->light;
  const double k = light.response(range_m, cosine, is_ellipsoid, ring, same_sensor_);
  return float(std::min(k * x, light.max_intensity));
}

float LearntLight::intensity(const elements::Model& model, const Ray& ray,
                             const trace::Intersection& met, double range_m, const BeamLog& beams,
                             size_t i, uint64_t key) {
  if (!model.light.known()) return 0;
  set(model);
  const elements::Reflectance of = elements::reflectance(model, met.element);
  if (of.mean <= 0) return 0;
  if (met.instance != instance_ || beams.time_s[i] != time_s_) {
    instance_ = met.instance;
    time_s_ = beams.time_s[i];
    model_from_world_ =
        world_.placed(instance_, time_s_).world_from_model.rotation.toRotationMatrix().transpose();
  }
  const double cosine =
      elements::incidence_cosine(model, met.element, model_from_world_ * ray.direction);
  const bool is_ellipsoid = model.kind(met.element) == elements::Kind::kEllipsoid;
  return answer({of.mean, of.spread}, cosine, is_ellipsoid, met.element, range_m, beams.ring[i],
                key);
}

float LearntLight::of_unknown(const Ray& ray, double range_m, const BeamLog& beams, size_t i,
                              uint64_t key) {
  const elements::Model& model = world_.model(0);  // Only a single model has unknown space.
  if (!model.light.known()) return 0;
  set(model);
  const Vec3 end = ray.at(range_m);
  const bool is_low =
      world_.world().unknown_space()->height(end) < elements::ObservedSpace::kGroundM;
  const elements::MeanReflectance& of = world_.unknown_reflectance(is_low);
  if (of.mean <= 0) return 0;
  // The ground is level, and matter has no surface to incline.
  const double cosine = is_low ? std::abs(ray.direction.z()) : 1 / std::sqrt(3.0);
  return answer(of, cosine, !is_low, trace::kUnknown, range_m, beams.ring[i], key);
}

}  // namespace underbrush::simulate
