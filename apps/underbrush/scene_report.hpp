/// \file
/// The counts of a composed scene as JSON and as text.
#pragma once
#include <string>

#include "cli/verb.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::app {

/// Returns counts of what was placed and left out, as JSON and as text.
Json json_of(const primitives::Composition& c);
std::string text_of(const primitives::Composition& c);

}  // namespace underbrush::app
