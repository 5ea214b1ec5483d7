/// \file
/// A map of the cells that beams crossed, while it is made.
#pragma once
#include <array>
#include <memory>

#include "underbrush/elements/observed_space.hpp"

namespace underbrush::calibrate {

/// Numbers of beams by cell, which only rise. The sum of maps does not depend on their order.
class ObservedMap {
 public:
  ObservedMap() = default;
  explicit ObservedMap(double cell_m) : cell_m_(cell_m) {}

  /// Adds the path of a beam (frame of the model), sampled twice per cell.
  void add(const Vec3& origin, const Vec3& direction, double from_m, double to_m);
  /// Adds the beams of another map, whose cells are of the same size.
  void add(const ObservedMap& other);
  /// The cells as a model keeps them.
  elements::ObservedSpace space() const;

 private:
  /// Counts a beam in a cell.
  void add(const Cell3& cell);
  elements::ObservedBlock& block_at(const Cell3& at);

  double cell_m_ = 1;
  CellMap<Cell3, std::unique_ptr<elements::ObservedBlock>> blocks_;
  /// The last block of each place in a cube of blocks, which the next beams cross again.
  std::array<elements::ObservedBlock*, 256> recent_{};
};

}  // namespace underbrush::calibrate
