/// \file
/// This file has some beams of a log with the elements that each of them may meet.
#pragma once
#include <vector>

#include "underbrush/fit/pass_kernel.hpp"

namespace underbrush::fit {

/// Some beams of a log with the elements that each of them may meet.
struct BeamBlock {
  std::vector<ListedBeam> beams;
  /// Beam b has the meetings `first[b]` up to `first[b + 1]`, those with triangles before the
  /// others. The former begin at `first_triangle[b]` of `on_triangle`.
  std::vector<uint32_t> first, first_triangle;
  std::vector<uint32_t> met;  ///< The number of the element of each meeting.
  std::vector<TriangleMeeting> on_triangle;
};

/// The meetings of one element in a block: `met[begin]` up to that of the next element.
struct MetElement {
  uint32_t element, begin;
};

/// The meetings of a block by element.
struct MeetingsByElement {
  /// The elements with meetings in order of their numbers, and a last entry that ends the list.
  std::vector<MetElement> elements;
  std::vector<ElementMeeting> met;
};

/// Sorts the meetings of a block by element. `elements` is the number of elements of the model.
MeetingsByElement by_element(const BeamBlock& block, size_t elements);

}  // namespace underbrush::fit
