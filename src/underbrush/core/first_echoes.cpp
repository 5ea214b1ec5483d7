#include "underbrush/core/first_echoes.hpp"

namespace underbrush {

FirstEchoes::FirstEchoes(BeamSource& source) : source_(source), beams_(source.size()) {
  source.rewind();
  BeamLog chunk;
  bool some = next(chunk);
  if (some && chunk.extra.count(kEchoColumn)) {
    for (beams_ = 0; some; some = next(chunk)) beams_ += chunk.size();
  }
  source.rewind();
}

bool FirstEchoes::next(BeamLog& chunk) {
  // A chunk may hold nothing but further echoes; then the next one is read.
  while (source_.next(chunk)) {
    keep_first_echoes(chunk);
    if (!chunk.empty()) return true;
  }
  return false;
}

}  // namespace underbrush
