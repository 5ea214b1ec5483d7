/// \file
/// Suggestions for mistyped names.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace underbrush {

/// Returns the name in `known` that takes the fewest insertions, deletions, replacements and
/// swaps of neighbours among its letters, small or capital, to become `name` (the first of equals),
/// or "" if these are more than half of the known name's letters. Where a known name has a dash,
/// the part behind it may match in place of the whole.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace underbrush
