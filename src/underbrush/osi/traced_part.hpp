/// \file
/// A part of the world that a lidar's rays meet: the static world, or the movers at one time. This
/// file is internal to the module.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/simulate/reflection.hpp"

namespace underbrush::osi {

/// The place and the effect of the nearest matter on a ray.
struct Meeting {
  double range_m = 0;  ///< 0 = nothing.
  double factor = 0;   ///< Reflectance times the effect of the incidence.
  uint32_t instance = 0;
};

/// Models that are placed, ready to be traced.
class TracedPart {
 public:
  /// `info` has the labels and materials of the scene; a scene without instances is its first
  /// model. Throws `std::invalid_argument` for an unknown material.
  TracedPart(elements::Scene scene, const elements::SceneInfo& info,
             const radiometry::Materials& materials, double wavelength_m);

  /// Traces rays at a time and replaces the entries of `nearest` by nearer meetings. Matter has the
  /// seed, and the sensor's noise on ray k the key `keys[k]`. Instances are numbered from
  /// `first_instance`.
  void trace(std::span<const Ray> rays, std::span<const uint64_t> keys, uint64_t seed,
             double time_s, const trace::RangeLimits& limits, uint32_t first_instance,
             std::span<Meeting> nearest) const;

 private:
  elements::Scene scene_;
  double sway_s_;
  trace::World world_;
  simulate::DynamicWorld dynamic_;
  simulate::Reflection reflection_;
};

}  // namespace underbrush::osi
