/// \file
/// This file has some beams of a log with the elements that each of them may meet.
#pragma once
#include <vector>

#include "underbrush/fit/pass_kernel.hpp"

namespace underbrush::fit {

/// Some beams of a log with the elements that each of them may meet.
struct BeamBlock {
  std::vector<ListedBeam> beams;
  std::vector<uint8_t> held_out;  ///< Whether a beam is held out.
  /// Beam b has the meetings `first[b]` up to `first[b + 1]`, in order of range at the search, and
  /// those of them that are with triangles begin at `first_triangle[b]`.
  std::vector<uint32_t> first, first_triangle;
  std::vector<uint32_t> met;  ///< The number of the element of each meeting.
  std::vector<TriangleMeeting> on_triangle;

  size_t bytes() const;
};

/// The meetings of one element in a block: `met[begin]` up to that of the next element.
struct MetElement {
  uint32_t element, begin;
};

/// The meetings of a block by element.
struct MeetingsByElement {
  /// The elements with meetings of beams that are not held out, in order of their numbers, and a
  /// last entry that ends the list.
  std::vector<MetElement> elements;
  std::vector<ElementMeeting> met;
};

/// Sorts the meetings of a block's beams that are not held out by element. `elements` is the number
/// of elements of the model.
MeetingsByElement by_element(const BeamBlock& block, size_t elements);

}  // namespace underbrush::fit
