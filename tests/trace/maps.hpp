/// \file
/// Maps of observed space for tests.
#pragma once
#include <cstdint>

#include "underbrush/core/rng.hpp"
#include "underbrush/elements/observed_space.hpp"

namespace underbrush::trace {

/// A map of `side`² columns of four blocks, of which beams crossed all cells but a few.
inline elements::ObservedSpace space_with_holes(int32_t side, double share_of_holes) {
  elements::ObservedSpace space;
  Stream random(53);
  for (int32_t x = -side / 2; x < (side + 1) / 2; ++x) {
    for (int32_t y = -side / 2; y < (side + 1) / 2; ++y) {
      for (int32_t z = -2; z < 2; ++z) {
        elements::ObservedBlock block;
        block.at = {x, y, z};
        for (uint8_t& n : block.beams) n = uint8_t(random.uniform() >= share_of_holes);
        space.blocks.push_back(block);
      }
    }
  }
  return space;
}

}  // namespace underbrush::trace
