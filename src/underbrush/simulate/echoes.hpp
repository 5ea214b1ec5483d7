/// \file
/// This file simulates the beams of an instrument: sub-rays over the beam, the light that they
/// bring back, the waveform, and its echoes.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/channel_offsets.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/radiometry/receiver.hpp"
#include "underbrush/sensor/beam.hpp"
#include "underbrush/simulate/dynamic_world.hpp"
#include "underbrush/simulate/learnt_light.hpp"
#include "underbrush/simulate/reflection.hpp"
#include "underbrush/simulate/sub_ray_tracer.hpp"
#include "underbrush/simulate/sub_returns.hpp"

namespace underbrush::simulate {

/// An instrument, from the beam that leaves it to the echoes that it reports.
struct Instrument {
  sensor::BeamShape beam;
  /// Made by `sensor::spread_sub_rays` or `sensor::grid_sub_rays`. A single sub-ray in the middle
  /// is a thin ray.
  std::vector<sensor::SubRay> sub_rays{{}};
  radiometry::ReceiverOptions receiver;
  /// The beam of the log that the models were fitted to, if its footprint is in them. A fit treats
  /// the ranges of such a beam as those of a thin ray, so that all silhouettes are wider by half of
  /// this beam. An instrument undoes that: it returns nothing where less than half of the area of
  /// the fitted beam returns.
  std::optional<sensor::BeamShape> fitted_beam{};
};

/// A choice of the beams whose waveforms are kept: the first `count` of beams 0, `every`, 2
/// `every`, …
struct WaveformChoice {
  size_t every = 1, count = 0;
  bool wants(size_t beam) const { return beam % every == 0 && beam / every < count; }
};

/// The waveform of a beam as its receiver digitised it, in units of the noise in the dark.
struct BeamWaveform {
  size_t beam = 0;  ///< Number in the log of beams.
  uint32_t scan = 0;
  uint16_t ring = 0;
  double time_s = 0;
  std::vector<std::pair<double, double>> signal;  ///< Range (m) and signal; gaps are left out.
  std::vector<double> echo_m;                     ///< Ranges of the echoes.
};

/// Adds the offset of its ring to all ranges of each waveform, as to those of a log's hits.
void add_offsets(const ChannelOffsets& offsets, std::vector<BeamWaveform>& waveforms);

/// The options of `EchoMaker`.
struct EchoOptions {
  uint64_t seed = 1;
  /// Whether to add the columns `element` and `element_class`, which are those of the sub-return
  /// nearest to the echo.
  bool element_ids = false;
  std::vector<elements::Class> instance_labels{};  ///< As in `Options`.
  WaveformChoice waveforms;
  double sway_s = 0;  ///< s; as in `Options`.
  /// If set, the intensity of an echo is the mean over its sub-rays of the light that the models
  /// have learnt (`LearntLight`), in the unit of their log, and not that of the receiver.
  std::optional<IntensityDraw> learnt_light{};
  /// Whether to trace all sub-rays of every beam, where the matter is drawn once and a few could
  /// stand for all (`SubRayTracer`).
  bool all_sub_rays = false;
};

/// A simulation that answers beams with echoes.
///
/// The sub-rays of a beam are traced as rays of the model, each with random trials and ranges of
/// its own, so that the hit probability of an element is the share of the light that it stops. The
/// beam's azimuth is off by a random angle within the encoder's step. Each return has the power
/// that the lidar equation gives (`Receiver::signals` with the factors of `Reflection`), and the
/// receiver makes echoes of their sum.
///
/// Random numbers have the key (seed, scan, number of the beam), so neither chunks nor threads
/// change the answer. The first sub-ray has the key with which a thin ray of the beam is traced.
class EchoMaker {
 public:
  /// Everything passed must outlive it. Throws `std::invalid_argument` for options out of range.
  EchoMaker(const DynamicWorld& world, const Reflection& reflection, const Instrument& instrument,
            const EchoOptions& options);
  ~EchoMaker();

  /// Replaces `beams` (one row per beam) by their echoes (one or more rows per beam). `first_beam`
  /// is the number of the first beam. Extra columns of the beams are kept. Range limits are those
  /// of `beams.info`, because the range of the instrument is limited by the receiver, not by the
  /// log that a model was fitted to. `cached` is empty or has one entry per beam: where it is set,
  /// it is the answer to that beam (`keyframe_answers`), of which there is no waveform.
  void answer(size_t first_beam, BeamLog& beams,
              std::span<const std::optional<keyframes::CachedReturn>> cached = {});

  /// The waveforms of the chosen beams so far.
  const std::vector<BeamWaveform>& waveforms() const { return waveforms_; }
  /// Gives away the waveforms of the chosen beams so far.
  std::vector<BeamWaveform> take_waveforms() { return std::exchange(waveforms_, {}); }
  /// The number of sub-rays that were traced so far.
  size_t rays() const { return rays_; }

 private:
  struct Block;
  struct Element;
  struct Scratch;
  class Scratches;
  struct Request;
  void receive(const Request& request, size_t begin, size_t end, Scratch& s, Block& block) const;
  radiometry::Echoes echoes_of(const Request& request, size_t i, const TracedBeams::Beam& beam,
                               Scratch& s, radiometry::Receiver::Way way) const;
  bool returns_enough(const SubReturns& returns, uint64_t key) const;
  Element element_at(float range_m, const SubReturns& returns,
                     std::span<const trace::Intersection> met) const;
  void write(const std::vector<Block>& blocks, BeamLog& beams) const;

  const DynamicWorld& world_;
  const Reflection& reflection_;
  const Instrument& instrument_;
  EchoOptions options_;
  SubRayTracer tracer_;
  radiometry::Receiver receiver_;
  std::unique_ptr<Scratches> scratches_;
  std::vector<double> least_share_;  ///< The energy that must return, by range (whole m).
  std::vector<BeamWaveform> waveforms_;
  std::atomic<size_t> rays_ = 0;
};

}  // namespace underbrush::simulate
