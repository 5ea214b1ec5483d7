/// \file
/// This file has some beams of a log with the elements that each of them may meet.
#pragma once
#include <span>
#include <vector>

#include "underbrush/likelihood/pass_kernel.hpp"

namespace underbrush::likelihood {

/// Some beams of a log with the elements that each of them may meet.
struct BeamBlock {
  std::span<const ListedBeam> beams;
  /// Beam b has the meetings `first[b]` up to `first[b + 1]`, those with triangles before the
  /// others. The former begin at `first_triangle[b]` of `on_triangle`.
  std::vector<uint32_t> first, first_triangle;
  std::vector<uint32_t> met;  ///< The number of the element of each meeting.
  std::vector<TriangleMeeting> on_triangle;
};

}  // namespace underbrush::likelihood
