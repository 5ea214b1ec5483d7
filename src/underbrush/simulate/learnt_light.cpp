#include "underbrush/simulate/learnt_light.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::simulate {

float LearntLight::intensity(const elements::Model& model, const Ray& ray,
                             const trace::Intersection& met, const BeamLog& beams, size_t i,
                             uint64_t key) {
  if (!model.light.known()) return 0;
  if (model_ != &model) {
    model_ = &model;
    same_sensor_ = model.sensor == sensor_ && model.sensor_file == sensor_file_;
  }
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
  double x = of.mean;
  if (draw_ == IntensityDraw::kDrawn) {
    const double relative = double(of.spread) / double(of.mean);
    const double variance = std::log1p(relative * relative);  // of ln x
    const double n = normal(key, met.element, Purpose::kSignal);
    x *= std::exp(std::sqrt(variance) * n - 0.5 * variance);
  }
  const double k =
      model.light.response(beams.range_m[i], cosine, is_ellipsoid, beams.ring[i], same_sensor_);
  return float(std::min(k * x, model.light.max_intensity));
}

}  // namespace underbrush::simulate
