/// \file
/// The order in which rays are traced: those that point alike together.
#pragma once
#include <cstdint>
#include <span>

#include "underbrush/core/ray.hpp"

namespace underbrush::trace {

/// Rays that are ordered at a time; more are cut into runs of so many.
inline constexpr size_t kOrdered = 8192;

/// Writes to `order` the numbers of up to `kOrdered` rays along a space-filling curve over the
/// sphere of directions; rays of nearly one direction keep their order. `order` and `scratch` are
/// of the rays' size.
void order_by_direction(std::span<const Ray> rays, std::span<uint32_t> order,
                        std::span<uint32_t> scratch);

}  // namespace underbrush::trace
