/// \file
/// Labels of one set in the numbers of another.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace underbrush::serve {

/// Returns the number of the set `to` that comes nearest to a number of the set `from`
/// (`elements::labels_of`), or nothing where it has none. Names that both sets have stay as they
/// are; else ground, grass, shrubs and trees are translated. Sets without sizes of plants yield
/// shrubs and trees of medium size, and SemanticKITTI's vegetation yields shrubs.
std::optional<uint32_t> label_in_set(std::string_view from, uint32_t number, std::string_view to);

/// Returns the place of a number in the list of a set, or nothing.
std::optional<uint32_t> place_in_set(std::string_view set, uint32_t number);

}  // namespace underbrush::serve
