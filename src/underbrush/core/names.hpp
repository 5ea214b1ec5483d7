/// \file
/// Names that people mistype.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace underbrush {

/// The one of `known` that takes the fewest insertions, deletions and replacements of letters to
/// become `name` (the first of equals), or "" if that is more than half of its letters. What
/// follows a dash may stand for the whole.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace underbrush
