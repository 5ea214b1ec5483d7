/// \file
/// All primitives of a set on one page.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::primitives {

/// An HTML page that loads nothing else and needs no script: a figure for each entry, by class.
/// `pictures` are PNG bytes, one an entry; `metres` what each of them shows from top to bottom.
std::string contact_sheet(std::span<const PrimitiveEntry> entries,
                          std::span<const std::vector<uint8_t>> pictures,
                          std::span<const double> metres);

}  // namespace underbrush::primitives
