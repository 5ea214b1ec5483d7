#include "underbrush/metrics/scan_pairs.hpp"

#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush::metrics {
namespace {

/// Hands out beams of a source in order.
class Reader {
 public:
  explicit Reader(BeamSource& source) : source_(source) { source_.rewind(); }

  /// Moves to the next beam. Returns false at the end.
  bool step() {
    if (++at_ < chunk_.size()) return true;
    at_ = 0;
    return source_.next(chunk_) && !chunk_.empty();
  }
  const BeamLog& chunk() const { return chunk_; }
  size_t at() const { return at_; }

 private:
  BeamSource& source_;
  BeamLog chunk_;
  size_t at_ = 0;
};

}  // namespace

void for_each_scan(BeamSource& real, BeamSource& simulated, const ScanPair& visit) {
  if (real.size() != simulated.size()) {
    throw DataError("score: " + std::to_string(real.size()) + " real beams but " +
                    std::to_string(simulated.size()) + " simulated ones");
  }
  Reader a(real), b(simulated);
  BeamLog scan[2];
  const auto hand_out = [&] {
    if (!scan[0].empty()) visit(scan[0], scan[1]);
    scan[0] = a.chunk().like();
    scan[1] = b.chunk().like();
  };
  for (size_t i = 0; a.step(); ++i) {
    require_data(b.step(), "score: the simulated log ends early");
    const BeamLog& x = a.chunk();
    const BeamLog& y = b.chunk();
    if (x.scan[a.at()] != y.scan[b.at()] || x.ring[a.at()] != y.ring[b.at()]) {
      throw DataError("score: the logs are not of the same beams (beam " + std::to_string(i) + ")");
    }
    if (scan[0].empty() || scan[0].scan.back() != x.scan[a.at()]) hand_out();
    scan[0].append(x, a.at());
    scan[1].append(y, b.at());
  }
  if (!scan[0].empty()) visit(scan[0], scan[1]);
}

Mat3 sensor_from_world(const LogInfo& info, uint32_t scan) {
  for (const ScanInfo& s : info.scans) {
    if (s.scan == scan) return s.world_from_sensor.rotation.conjugate().toRotationMatrix();
  }
  return Mat3::Identity();
}

}  // namespace underbrush::metrics
