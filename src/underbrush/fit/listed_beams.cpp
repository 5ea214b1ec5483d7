#include "underbrush/fit/listed_beams.hpp"

#include <algorithm>

#include "underbrush/core/parallel.hpp"

namespace underbrush::fit {
namespace {

/// Elements beyond a return count if their closest approach lies up to this much farther, because
/// their Gaussians reach back to the return, m.
constexpr double kBeyondM = 4;

}  // namespace

ListedBeams::ListedBeams(BeamSource& source, const HeldOut& held_out, const elements::Model& model,
                         size_t most_bytes)
    : source_(source),
      rule_(held_out),
      origin_(model.origin),
      most_range_m_(std::min(source.info().max_range_m, model.max_range_m)) {
  size_t bytes = 0;
  source_.rewind();
  for (BeamLog chunk; source_.next(chunk);) {
    const std::vector<ListedBeam> apart = beams_of(chunk, true);
    judging_.insert(judging_.end(), apart.begin(), apart.end());
    const size_t n = chunk.size() - apart.size();
    training_beams_ += n;
    bytes += n * sizeof(ListedBeam);
    complete_ &= bytes <= most_bytes;
    if (complete_) kept_.push_back(beams_of(chunk, false));
  }
}

std::vector<ListedBeam> ListedBeams::beams_of(const BeamLog& chunk, bool held_out) const {
  const std::vector<uint8_t> apart = rule_.of(chunk);
  std::vector<uint32_t> rows;
  for (size_t i = 0; i < chunk.size(); ++i) {
    if ((apart[i] != 0) == held_out) rows.push_back(uint32_t(i));
  }
  std::vector<ListedBeam> out(rows.size());
  parallel_for(rows.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const size_t i = rows[k];
      const Vec3f origin = (chunk.origin[i] - origin_).cast<float>();
      const Vec3f direction = chunk.ray(i).direction.cast<float>();
      const double reach = std::min(double(chunk.range_m[i]) + kBeyondM, most_range_m_);
      out[k] = {{origin[0], origin[1], origin[2]},
                chunk.range_m[i],
                {direction[0], direction[1], direction[2]},
                float(reach)};
    }
  });
  return out;
}

void ListedBeams::for_each(const std::function<void(BeamBlock&)>& use) const {
  BeamBlock block;
  for (const std::vector<ListedBeam>& beams : kept_) {
    block.beams = beams;
    use(block);
  }
  if (complete_) return;
  size_t number = 0;
  source_.rewind();
  for (BeamLog chunk; source_.next(chunk);) {
    if (number++ < kept_.size()) continue;
    block.beams = beams_of(chunk, false);
    use(block);
  }
}

}  // namespace underbrush::fit
