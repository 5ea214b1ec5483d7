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

Baseline always_hit(const OpenLog& real, const OpenLog& train, ScoreOptions options) {
  options.cloud = false;
  const auto medians_of = train ? train() : real(), truth = real(), beams = real();
  AlwaysHit simulated(RingMedians(*medians_of), *beams);
  return {"always hit", score(*truth, simulated, options)};
}

Baseline look_up(const OpenLog& real, const OpenLog& train, const ScoreOptions& options) {
  const auto truth = real();
  const BeamLog answered = looked_up(whole(*train()), whole(*truth), LookUp::kWarped2);
  MemorySource simulated(answered);
  return {"look-up", score(*truth, simulated, options)};
}

}  // namespace

std::vector<Baseline> score_baselines(const OpenLog& real, const OpenLog& train,
                                      const ScoreOptions& options) {
  std::vector<Baseline> out{always_hit(real, train, options)};
  if (train) out.push_back(look_up(real, train, options));
  return out;
}

}  // namespace underbrush::metrics
