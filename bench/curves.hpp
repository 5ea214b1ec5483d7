// Rays per second against the number of elements, as a picture.
#pragma once
#include <string>

#include "contest.hpp"

namespace underbrush::bench {

/// Draws `rays_per_s_per_core` of the cases that have the value `of` for `key`, one ray per beam,
/// against their number of `counted` ("elements" or "triangles"). Of Embree's ways it draws the
/// fastest one.
void plot_curves(const Json& cases, const std::string& key, const std::string& of,
                 const std::string& counted, const std::string& title, const std::string& file);

}  // namespace underbrush::bench
