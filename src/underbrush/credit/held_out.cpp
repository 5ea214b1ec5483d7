#include "underbrush/credit/held_out.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::credit {

bool HeldOut::operator()(const BeamLog& log, size_t i) const {
  if (one_in == 0) return false;
  const Vec3f& d = log.direction[i];
  const float turn = d.y() / std::max(std::abs(d.x()) + std::abs(d.y()), 1e-9f);
  const uint32_t cell = uint32_t(int(std::floor(256 * turn)) + 256) * 2 + (d.x() > 0);
  const uint64_t group = uint64_t(log.packet[i]) << 32 | cell;
  return random_bits(beam_key(seed, log.scan[i], group), 0, Purpose::kSplit) % one_in == 0;
}

std::vector<uint8_t> HeldOut::of(const BeamLog& log) const {
  std::vector<uint8_t> out(log.size());
  parallel_for(log.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out[i] = (*this)(log, i);
  });
  return out;
}

unsigned BeamShare::number_of(const BeamLog& log, size_t i) {
  const Vec3f& d = log.direction[i];
  const auto bits = [](float x) { return uint64_t(std::bit_cast<uint32_t>(x)); };
  const uint64_t key = mix64(bits(d.x()) << 32 | bits(d.y())) ^ (bits(d.z()) << 32);
  return unsigned(mix64(key ^ bits(log.range_m[i])) >> 32) % kParts;
}

bool TrainingSource::next(BeamLog& chunk) {
  BeamLog all;
  while (source_.next(all)) {
    std::vector<uint8_t> apart = held_out_.of(all);
    if (!share_.is_all()) {
      parallel_for(all.size(), 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) apart[i] |= !share_.has(all, i);
      });
    }
    chunk = all.like();
    chunk.reserve(all.size());
    for (size_t i = 0, from = 0; i <= all.size(); ++i) {
      if (i < all.size() && !apart[i]) continue;
      if (from < i) chunk.append(all, from, i);
      from = i + 1;
    }
    if (!chunk.empty()) return true;
  }
  chunk = all;
  return false;
}

}  // namespace underbrush::credit
