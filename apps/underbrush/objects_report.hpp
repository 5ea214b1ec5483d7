/// \file
/// The objects of a labelled log, and the primitives that were cut along them, as JSON and as text.
#pragma once
#include <string>

#include "cli/verb.hpp"
#include "underbrush/primitives/extract.hpp"

namespace underbrush::app {

/// Returns the objects by class, and what was left out, as JSON and as text.
Json json_of(const primitives::MeasuredObjects& measured);
std::string text_of(const primitives::MeasuredObjects& measured);

/// Returns the primitives by class, and what was left out, as JSON and as text.
Json json_of(const primitives::ExtractResult& result);
std::string text_of(const primitives::ExtractResult& result);

}  // namespace underbrush::app
