#include "underbrush/core/read_ahead.hpp"

#include <utility>

namespace underbrush {

ReadAhead::ReadAhead(BeamSource& source)
    : source_(source), info_(source.info()), size_(source.size()) {}

void ReadAhead::rewind() {
  background_.wait();
  source_.rewind();
  info_ = source_.info();
  is_begun_ = is_at_end_ = false;
}

void ReadAhead::start() {
  background_.start([this] {
    is_at_end_ = !source_.next(ahead_);
    info_ahead_ = source_.info();
  });
}

bool ReadAhead::next(BeamLog& chunk) {
  if (!is_begun_) start();
  is_begun_ = true;
  background_.wait();
  std::swap(chunk, ahead_);  // so that the memory of the caller's last chunk is used again
  info_ = info_ahead_;
  if (is_at_end_) {
    chunk = BeamLog();
    return false;
  }
  start();
  return true;
}

}  // namespace underbrush
