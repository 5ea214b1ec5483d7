/// \file
/// The places where a world has changed.
#pragma once
#include <vector>

#include "underbrush/update/update_report.hpp"

namespace underbrush::update {

/// Finds the squares where most of the ellipsoids with these means (m, world) have gone, at most
/// ten, those with the most first.
std::vector<ChangedPlace> changed_places(const std::vector<Vec3>& gone);

}  // namespace underbrush::update
