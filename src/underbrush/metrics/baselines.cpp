#include "underbrush/metrics/baselines.hpp"

#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/metrics/look_up.hpp"

namespace underbrush::metrics {
namespace {

BeamLog whole(BeamSource& source) {
  BeamLog log, chunk;
  log.info = source.info();
  source.rewind();
  while (source.next(chunk)) log.append(chunk, 0, chunk.size());
  return log;
}

}  // namespace

void answer_by_baselines(const OpenLog& real, const OpenLog& train, const UseBaseline& use) {
  const auto truth = real();
  {
    const auto medians_of = train ? train() : real(), beams = real();
    AlwaysHit simulated(RingMedians(*medians_of), *beams);
    use(kAlwaysHit, *truth, simulated);
  }
  if (!train) return;
  const BeamLog answered = looked_up(whole(*train()), whole(*truth), LookUp::kWarped2);
  MemorySource simulated(answered);
  use(kLookUp, *truth, simulated);
}

}  // namespace underbrush::metrics
