#include "underbrush/core/still_beams.hpp"

#include <algorithm>

namespace underbrush {
namespace {

bool is_marked(uint8_t flags) { return (flags & kMover) != 0; }

// The rows of the beams without a marked row.
BeamLog without_movers(const BeamLog& chunk) {
  BeamLog out = chunk.like();
  const std::vector<bool> begins = begins_beam(chunk);
  for (size_t begin = 0, end = 0; begin < chunk.size(); begin = end) {
    bool marked = is_marked(chunk.flags[begin]);
    for (end = begin + 1; end < chunk.size() && !begins[end]; ++end) {
      marked |= is_marked(chunk.flags[end]);
    }
    if (!marked) out.append(chunk, begin, end);
  }
  return out;
}

}  // namespace

void StillBeams::rewind() {
  source_.rewind();
  now_ = 0;
}

bool StillBeams::next(BeamLog& chunk) {
  while (source_.next(chunk)) {
    if (std::none_of(chunk.flags.begin(), chunk.flags.end(), is_marked)) return true;
    const size_t rows = chunk.size();
    chunk = without_movers(chunk);
    now_ += rows - chunk.size();
    left_out_ = std::max(left_out_, now_);
    if (!chunk.empty()) return true;
  }
  return false;
}

}  // namespace underbrush
