/// \file
/// The entries of a set of primitives.
#pragma once
#include <string>

#include "underbrush/primitives/extract.hpp"

namespace underbrush::primitives {

/// The entry of a primitive in the manifest.
struct PrimitiveEntry {
  elements::Class label = elements::Class::kUnknown;
  Box box;
  std::string name;  ///< CLASS/NUMBER, which is its folder in the set.
  size_t elements = 0, points = 0;
  PointLayers layers;           ///< As in `PlacedObject`.
  uint32_t origin = 0;          ///< Index into `PrimitiveSet::origins`, if it has any.
  BoxBeams beams = {};          ///< As in `PlacedObject`.
  std::string given_name = {};  ///< As in `Primitive`.
};

}  // namespace underbrush::primitives
