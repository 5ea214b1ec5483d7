/// \file
/// This file has a table for fast normal noise.
#pragma once
#include <array>

namespace underbrush::radiometry {

/// The quantiles of the standard normal distribution at (k + ½)/4096, scaled to variance 1.
const std::array<float, 4096>& normal_quantiles();

}  // namespace underbrush::radiometry
