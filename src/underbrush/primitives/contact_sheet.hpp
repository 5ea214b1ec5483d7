/// \file
/// A page that shows all primitives of a set.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "underbrush/primitives/primitive_entry.hpp"

namespace underbrush::primitives {

/// Returns an HTML page with a figure for each entry, sorted by class. The page loads no other file
/// and needs no script. `pictures` are PNG bytes, one for each entry; `metres` are the heights that
/// they show from top to bottom.
std::string contact_sheet(std::span<const PrimitiveEntry> entries,
                          std::span<const std::vector<uint8_t>> pictures,
                          std::span<const double> metres);

}  // namespace underbrush::primitives
