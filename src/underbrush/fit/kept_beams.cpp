#include "underbrush/fit/kept_beams.hpp"

#include <algorithm>

namespace underbrush::fit {
namespace {

size_t bytes_of_beam(const BeamLog& log) {
  size_t bytes = sizeof(Vec3) + sizeof(Vec3f) + 2 * sizeof(float) + sizeof(double) +
                 sizeof(uint16_t) + 2 * sizeof(uint32_t) + sizeof(uint8_t);
  for (const auto& [name, column] : log.extra) {
    bytes += std::visit([](const auto& c) { return sizeof(c[0]); }, column);
  }
  return bytes;
}

}  // namespace

void KeptBeams::rewind() {
  at_ = 0;
  if (is_long_) source_.rewind();
}

bool KeptBeams::next(BeamLog& chunk) {
  if (at_ < kept_.size()) {
    chunk = kept_[at_++];
    return true;
  }
  if (!source_.next(chunk)) return false;
  if (kept_.empty()) is_long_ = source_.size() > most_bytes_ / bytes_of_beam(chunk);
  if (!is_long_) {
    kept_.push_back(chunk);
    ++at_;
  }
  return true;
}

}  // namespace underbrush::fit
