#include "underbrush/core/channel_offsets.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush {

void add_offsets(const ChannelOffsets& offsets, double sign, BeamLog& beams) {
  if (offsets.empty()) return;
  std::vector<double> of_ring(size_t(offsets.back().ring) + 1);
  for (const ChannelOffset& o : offsets) of_ring[o.ring] = sign * o.range_m;
  for (size_t i = 0; i < beams.size(); ++i) {
    if (!beams.is_hit(i) || beams.ring[i] >= of_ring.size()) continue;
    const double range = double(beams.range_m[i]) + of_ring[beams.ring[i]];
    beams.range_m[i] = float(std::max(range, kLeastRangeM));
  }
}

OffsetSpread spread_of(const ChannelOffsets& offsets) {
  if (offsets.empty()) return {};
  double offset = 0, error = 0;
  for (const ChannelOffset& o : offsets) {
    offset += o.range_m * o.range_m;
    error += o.standard_error_m * o.standard_error_m;
  }
  const double n = double(offsets.size());
  return {std::sqrt(offset / n), std::sqrt(error / n)};
}

bool CorrectedBeams::next(BeamLog& chunk) {
  if (!source_.next(chunk)) return false;
  add_offsets(offsets_, -1, chunk);
  return true;
}

}  // namespace underbrush
