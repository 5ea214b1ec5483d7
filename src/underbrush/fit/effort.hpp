/// \file
/// The efforts of a fit: how much of a long log it uses.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/credit/held_out.hpp"

namespace underbrush::fit {

/// An effort of a fit by `likelihood`. Its shares are those of long logs (`credit::kLongLog`); of
/// shorter ones all beams are used.
struct Effort {
  std::string_view name;
  credit::BeamShare start;  ///< The beams to which the start is fitted.
  /// The training beams of each M-step; further steps use the last share.
  std::span<const credit::BeamShare> steps;
  size_t samples_of_light;  ///< Returns from which the reflectance of an element is learnt, about.
};

/// The names of the efforts, from the fastest to the slowest one.
std::vector<std::string_view> effort_names();

/// Throws `std::invalid_argument` for an unknown name.
const Effort& effort_named(std::string_view name);

}  // namespace underbrush::fit
