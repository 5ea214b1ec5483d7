/// \file
/// The objects of a site that was drawn at random.
#pragma once
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::sites {

/// The classes that objects of a drawn site may have; empty where they may have any.
using Classes = std::vector<elements::Class>;

/// Whether objects may have a class.
inline bool is_allowed(const Classes& classes, elements::Class label) {
  return classes.empty() || std::find(classes.begin(), classes.end(), label) != classes.end();
}

/// Returns the classes of which a set has primitives. Throws `DataError` where it has none.
inline Classes classes_of(const primitives::PrimitiveSet& set) {
  require_data(!set.entries.empty(), "the set has no primitives");
  Classes out;
  for (const primitives::PrimitiveEntry& e : set.entries) out.push_back(e.label);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// The objects of a drawn site, and counts of those that were replaced or left out.
struct DrawnSite {
  std::vector<primitives::PlacedObject> objects;
  /// Objects that have another size of the same kind, because their class is not allowed, by that
  /// class. A piece of a patch counts as one.
  std::map<std::string, size_t> replaced;
  /// Objects left out, because no allowed class of their kind fits the site, by class.
  std::map<std::string, size_t> left_out;
  size_t off_ground = 0;     ///< Plants left out because no ground is below them.
  size_t missing_cells = 0;  ///< Cells of patches for which there was no room.
};

}  // namespace underbrush::sites
