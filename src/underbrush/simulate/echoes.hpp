/// \file
/// Beams as an instrument sees them: sub-rays over the beam, their light, the waveform, echoes.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/radiometry/receiver.hpp"
#include "underbrush/sensor/beam.hpp"
#include "underbrush/simulate/dynamic_world.hpp"
#include "underbrush/simulate/reflection.hpp"
#include "underbrush/simulate/sub_ray_bundle.hpp"
#include "underbrush/simulate/sub_returns.hpp"

namespace underbrush::simulate {

/// An instrument, from the beam that leaves it to the echoes that it reports.
struct Instrument {
  sensor::BeamShape beam;
  /// `sensor::spread_sub_rays` or `grid_sub_rays`; one in the middle is a thin ray.
  std::vector<sensor::SubRay> sub_rays{{}};
  radiometry::ReceiverOptions receiver;
};

/// Which beams' waveforms are wanted: number 0, `every`, 2 `every` …, of those the first `count`.
struct WaveformChoice {
  size_t every = 1, count = 0;
  bool wants(size_t beam) const { return beam % every == 0 && beam / every < count; }
};

/// A beam's waveform as its receiver digitised it, in units of the noise in the dark.
struct BeamWaveform {
  size_t beam = 0;  ///< Number in the log of beams.
  uint32_t scan = 0;
  uint16_t ring = 0;
  double time_s = 0;
  std::vector<std::pair<double, double>> signal;  ///< Range (m), signal; gaps left out.
  std::vector<double> echo_m;                     ///< Ranges of the echoes.
};

/// Options of `EchoMaker`.
struct EchoOptions {
  uint64_t seed = 1;
  bool element_ids = false;  ///< Add the columns `element` and `element_class`: of an echo the
                             ///< sub-return nearest to it.
  std::vector<elements::Class> instance_labels{};  ///< As those of `Options`.
  WaveformChoice waveforms;
};

/// Answers beams with echoes.
///
/// Of beam i the sub-rays are traced as rays of the model, each with trials and draws of its own:
/// the hit probability of an element is the share of the light that it stops. The beam's azimuth is
/// off within the encoder's step by a draw of its own. Every return has the power of the lidar
/// equation (`Receiver::signals` with `Reflection`'s factors); from their sum the receiver makes
/// echoes. Random numbers: key (seed, scan, number of the beam), so neither chunks nor threads
/// change the answer; the first sub-ray has the beam's key, with which a thin ray is traced.
class EchoMaker {
 public:
  /// Everything must outlive it. Throws `std::invalid_argument`.
  EchoMaker(const DynamicWorld& world, const Reflection& reflection, const Instrument& instrument,
            const EchoOptions& options);
  ~EchoMaker();

  /// Replaces `beams` (one row a beam) by their echoes (one or more rows a beam). Other extra
  /// columns are kept. `first_beam` is the number of the first. Ranges count within those of
  /// `beams.info`: the receiver, not the log that a model was fitted to, says how far it sees.
  void answer(size_t first_beam, BeamLog& beams);

  /// The waveforms asked for, of the beams so far.
  const std::vector<BeamWaveform>& waveforms() const { return waveforms_; }

 private:
  struct Block;
  struct Element;
  struct Scratch;
  class Scratches;
  void trace(const BeamLog& beams, size_t first_beam, size_t begin, size_t end, Scratch& s) const;
  void receive(const BeamLog& beams, size_t first_beam, size_t begin, size_t end, Scratch& s,
               Block& block) const;
  Element element_at(float range_m, const SubReturns& returns,
                     std::span<const trace::Intersection> met) const;
  void write(const std::vector<Block>& blocks, BeamLog& beams) const;

  const DynamicWorld& world_;
  const Reflection& reflection_;
  const Instrument& instrument_;
  EchoOptions options_;
  SubRayBundle sub_rays_;
  radiometry::Receiver receiver_;
  std::unique_ptr<Scratches> scratches_;
  std::vector<BeamWaveform> waveforms_;
};

}  // namespace underbrush::simulate
