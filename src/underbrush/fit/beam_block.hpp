/// \file
/// This file has some beams of a log with the elements that each of them may meet.
#pragma once
#include <vector>

#include "underbrush/fit/pass_kernel.hpp"

namespace underbrush::fit {

/// The meetings of one element in a block: `by_element[begin]` up to that of the next element.
struct MetElement {
  uint32_t element, begin;
};

/// Some beams of a log with the elements that each of them may meet.
struct BeamBlock {
  std::vector<ListedBeam> beams;
  std::vector<uint8_t> held_out;  ///< Whether a beam is held out.
  /// Beam b has the meetings `first[b]` up to `first[b + 1]`, in order of range at the search.
  std::vector<uint32_t> first;
  std::vector<Meeting> met;
  /// The elements with meetings of beams that are not held out, in order of their numbers, and a
  /// last entry that ends the list.
  std::vector<MetElement> elements;
  std::vector<ElementMeeting> by_element;

  size_t bytes() const;
};

}  // namespace underbrush::fit
