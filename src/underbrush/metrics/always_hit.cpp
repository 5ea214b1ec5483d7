#include "underbrush/metrics/always_hit.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "underbrush/core/median.hpp"

namespace underbrush::metrics {
RingMedians::RingMedians(BeamSource& log) {
  std::unordered_map<uint16_t, std::vector<float>> ranges;
  BeamLog chunk;
  log.rewind();
  while (log.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.is_hit(i) && !(chunk.flags[i] & kMover)) {
        ranges[chunk.ring[i]].push_back(chunk.range_m[i]);
      }
    }
  }
  std::vector<float> all;
  for (auto& [ring, of_ring] : ranges) {
    all.insert(all.end(), of_ring.begin(), of_ring.end());
    of_ring_[ring] = median(std::move(of_ring));
  }
  if (!all.empty()) of_all_ = median(std::move(all));
}

float RingMedians::of(uint16_t ring) const {
  const auto found = of_ring_.find(ring);
  return found == of_ring_.end() ? of_all_ : found->second;
}

BeamLog always_hit(const BeamLog& train, const BeamLog& test) {
  MemorySource medians_of(train), beams(test, std::max<size_t>(test.size(), 1));
  BeamLog out;
  AlwaysHit(RingMedians(medians_of), beams).next(out);
  return out;
}

bool AlwaysHit::next(BeamLog& chunk) {
  if (!beams_.next(chunk)) return false;
  for (size_t i = 0; i < chunk.size(); ++i) {
    chunk.range_m[i] = medians_.of(chunk.ring[i]);
    chunk.intensity[i] = 0;
  }
  return true;
}

}  // namespace underbrush::metrics
