#include "underbrush/fit/held_out.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::fit {

bool HeldOut::operator()(const BeamLog& log, size_t i) const {
  if (one_in == 0) return false;
  const Vec3f& d = log.direction[i];
  const float turn = d.y() / std::max(std::abs(d.x()) + std::abs(d.y()), 1e-9f);
  const uint32_t cell = uint32_t(int(std::floor(256 * turn)) + 256) * 2 + (d.x() > 0);
  const uint64_t group = uint64_t(log.packet[i]) << 32 | cell;
  return random_bits(beam_key(seed, log.scan[i], group), 0, Purpose::kSplit) % one_in == 0;
}

TrainingSource::TrainingSource(BeamSource& source, const HeldOut& held_out)
    : source_(source), held_out_(held_out) {
  source_.rewind();
  BeamLog chunk;
  while (source_.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i) size_ += !held_out_(chunk, i);
  }
  source_.rewind();
}

bool TrainingSource::next(BeamLog& chunk) {
  BeamLog all;
  while (source_.next(all)) {
    chunk = all.like();
    for (size_t i = 0, from = 0; i <= all.size(); ++i) {
      if (i < all.size() && !held_out_(all, i)) continue;
      if (from < i) chunk.append(all, from, i);
      from = i + 1;
    }
    if (!chunk.empty()) return true;
  }
  chunk = all;
  return false;
}

}  // namespace underbrush::fit
