/// \file
/// The scenario of [rosenberger20] Fig. 11, generated: a car drives up to a standing one, behind
/// which a third turns and is hidden meanwhile.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/perception/rig.hpp"
#include "underbrush/perception/truth.hpp"

namespace underbrush::studies {

/// Duration of the scenario, s.
inline constexpr double kIntersectionS = 7.62;
/// Numbers of the standing and of the turning car.
inline constexpr uint64_t kStandingCar = 1, kTurningCar = 2;

/// The scenario.
struct Intersection {
  perception::Rig rig;                        ///< Two Ibeo LUX 2010, front-left and front-right.
  Trajectory world_from_vehicle;              ///< The poses of the car with the sensors.
  std::vector<perception::ObjectList> truth;  ///< Every 20 ms.
};

/// Makes the scenario. The sizes, speeds and places are ours, because the paper gives none.
Intersection make_intersection();

/// Returns the log of the rig, with each beam as `columns` × `rows` sub-rays through the whole
/// instrument, and 0 sub-rays as a thin ray. Cars are boxes with a cabin.
BeamLog scan_intersection(const Intersection& scene, int columns, int rows, uint64_t seed);

}  // namespace underbrush::studies
