/// \file
/// The intensities of returns from a model with learnt light.
#pragma once
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/simulate/dynamic_world.hpp"

namespace underbrush::simulate {

/// The rule by which a return's intensity follows from its element.
enum class IntensityDraw {
  kMean,   ///< The expected intensity: the least squared error.
  kDrawn,  ///< Drawn with the spread within the element: the distribution of the log.
};

/// The intensities of the returns from a world. The data of a model are kept until another one is
/// asked for.
class LearntLight {
 public:
  /// `world` must outlive it; `beams` names the sensor.
  LearntLight(const DynamicWorld& world, const LogInfo& beams, IntensityDraw draw)
      : world_(world), sensor_(beams.sensor), sensor_file_(beams.sensor_file), draw_(draw) {}

  /// Computes the intensity of a return that beam i of `beams` has at a range (m) from the element
  /// that its ray met, in the unit of the log that `model` was fitted to: I = k x with the response
  /// k (`elements::Light`) and x either ρ or log-normal with the mean ρ and the element's spread,
  /// but at most the log's largest intensity. Gains of channels count where the sensor is that of
  /// the log. A model without light answers 0. `key` is the beam's.
  float intensity(const elements::Model& model, const Ray& ray, const trace::Intersection& met,
                  double range_m, const BeamLog& beams, size_t i, uint64_t key);
  /// Computes the intensity of a return from unknown space: from ground where the return is near
  /// the ground, else ellipsoids, with their mean reflectances.
  float of_unknown(const Ray& ray, double range_m, const BeamLog& beams, size_t i, uint64_t key);

 private:
  void set(const elements::Model& model);
  /// Computes the intensity of a return from an element of a reflectance and a number.
  float answer(const elements::MeanReflectance& of, double cosine, bool is_ellipsoid,
               uint32_t element, double range_m, uint16_t ring, uint64_t key) const;

  const DynamicWorld& world_;
  std::string sensor_, sensor_file_;
  IntensityDraw draw_;
  const elements::Model* model_ = nullptr;
  bool same_sensor_ = false;
  uint32_t instance_ = trace::Intersection::kNone;  ///< The instance of `model_from_world_`.
  double time_s_ = 0;
  Mat3 model_from_world_ = Mat3::Identity();
};

}  // namespace underbrush::simulate
