/// \file
/// The choice of the primitive that stands for an object.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/cells.hpp"
#include "underbrush/primitives/placed_object.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::primitives {

/// The rule by which a primitive is chosen among those of the object's class.
enum class Choice {
  kBox,     ///< The nearest box ‖extents − extents'‖ ([tallavajhula18] §IV).
  kBest,    ///< The nearest box and points, with variety (`Chooser`), adapted to the object.
  kRandom,  ///< Any primitive.
};

/// Chooses among the primitives of a set.
///
/// `kBest` takes the primitive of the least cost ‖extents − extents'‖ + w d + v r. The distance d
/// (m) is that of the places of the points in five layers (`PointLayers`) when the boxes stand upon
/// each other, as a root of the mean over the places; w = `kPointsWeight`. The difference r is that
/// of the logarithms of returns per metre in the boxes (`BoxBeams`); v = `kMatterWeightM`. Where
/// the layers of the object or the primitive are not known, d and r are 0; where the beams of one
/// are not known, r is 0. A primitive that stands within `kVarietyM` already is passed over if
/// another costs at most `kFitsM` more than the best.
class Chooser {
 public:
  static constexpr double kPointsWeight = 2, kMatterWeightM = 0.6;
  static constexpr double kVarietyM = 20, kFitsM = 0.5;  // m

  Chooser(const PrimitiveSet& set, Choice choice, size_t nearest);

  /// Returns the primitives that may stand for the class: those of the class, or else of its kind.
  const std::vector<uint32_t>& candidates(elements::Class c);
  /// Returns one of `from`, which is not empty. `draw` in [0, 1) chooses among the `nearest` best,
  /// or for `kRandom` among all; equal costs keep the set's order.
  uint32_t choose(const std::vector<uint32_t>& from, const PlacedObject& object, double draw);
  /// Forgets the objects below a line (m, world), which later objects do not come near.
  void forget_below(double y_m);

 private:
  double cost(uint32_t entry, const PlacedObject& object) const;
  bool stands_near(uint32_t entry, const Vec3& position) const;

  const PrimitiveSet& set_;
  Choice choice_;
  size_t nearest_;
  std::map<elements::Class, std::vector<uint32_t>> by_class_;
  std::map<elements::ClassKind, std::vector<uint32_t>> by_kind_;
  std::vector<std::pair<double, uint32_t>> order_;
  CellMap<Cell2, std::vector<std::pair<uint32_t, Eigen::Vector2d>>> placed_;  // Only of `kBest`.
};

}  // namespace underbrush::primitives
