#include "underbrush/core/beam_window.hpp"

#include <algorithm>

namespace underbrush {

size_t BeamWindow::size() const {
  const size_t end = std::min(end_, source_.size());
  return end - std::min(first_, end);
}

void BeamWindow::rewind() {
  at_ = 0;
  const bool is_part = first_ > 0 || end_ < source_.size();
  auto* const seekable = is_part ? dynamic_cast<SeekableSource*>(&source_) : nullptr;
  seekable ? void(at_ = seekable->seek(first_)) : source_.rewind();
}

bool BeamWindow::next(BeamLog& chunk) {
  while (at_ < end_ && source_.next(chunk)) {
    const size_t from = std::max(at_, first_), begin = at_;
    at_ += chunk.size();
    const size_t to = std::min(at_, end_);
    if (from >= to) continue;  // All of the chunk is before the window.
    if (to - from < chunk.size()) {
      BeamLog part = chunk.like();
      part.append(chunk, from - begin, to - begin);
      chunk = std::move(part);
    }
    return true;
  }
  chunk.resize(0);
  return false;
}

}  // namespace underbrush
