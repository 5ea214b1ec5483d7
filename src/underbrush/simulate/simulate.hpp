/// \file
/// This file has the main job of the library: beams go in, ranges come out.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/sensor/beam.hpp"
#include "underbrush/simulate/dynamic_world.hpp"
#include "underbrush/simulate/learnt_light.hpp"

namespace underbrush {
/// Simulation: it answers beams from a world.
namespace simulate {

/// The way in which a beam's range follows from the elements that it meets.
enum class RangeDraw {
  kOnRay,       ///< t ~ N(t_i, σ_i²), the Gaussian along the ray, [deschaud12] eq. 2–3.
  kVolumetric,  ///< A point from N(μ, Σ), which may lie off the beam, [tallavajhula18] §IV.
  kMedian,      ///< No draw: the median of all that the beam may measure (`median_answers`).
};

/// The options of `simulate`.
struct Options {
  uint64_t seed = 1;
  RangeDraw draw = RangeDraw::kOnRay;
  double range_noise_m = 0;  ///< σ of further noise on every range.
  IntensityDraw intensity = IntensityDraw::kMean;
  /// If positive, it replaces the maximum range of the beams.
  double max_range_m = 0;
  /// s; correlation time of matter that sways, for worlds of `trace::Draws::kSwaying`, and 0 for
  /// all others.
  double sway_s = 0;
  bool element_ids = false;  ///< Whether to add the extra columns `element` and `element_class`.
  /// Whether keyframes may answer. Sensors are distinguished by their names alone; of logs without
  /// one, the caller finds out whether the sensor is the same (`KeyframeCache::serves`).
  bool keyframes = true;
  /// The class of each instance of a scene. With `element_ids`, `element_class` is taken from here
  /// instead of from the element, and there is a column `instance`, which is 0 for the ground and
  /// for a miss.
  std::vector<elements::Class> instance_labels{};
  /// If set, the ray that is traced is drawn from this shape about each beam's axis ([deschaud12]
  /// §IV). The direction in the log stays that of the axis. If not, the axis is traced.
  std::optional<sensor::BeamShape> random_ray{};
};

/// Answers beams in place: the range of each becomes that of the nearest element that accepts it,
/// or a miss.
///
/// Beam i draws its random numbers from (seed, scan, first_beam + i), so neither chunks nor threads
/// change the answer. Volumetric draws also turn the beam's direction towards the drawn point.
/// Elements count at ranges within those of `beams.info` (or `options.max_range_m`) and up to the
/// `max_range_m` of the model of instance 0, which is the ground of a composed scene; limits of the
/// other models have no effect. Where a drawn range lies outside these limits, the element's own
/// range is taken. Intensities are those of the light that the models have learnt (`LearntLight`)
/// and 0 for models without. Where `keyframes_serve`, the answer is that of the mixture of
/// `elements::KeyframeWeights`, intensity included. `EchoMaker` has those of an instrument and of
/// materials. Throws `std::invalid_argument` for options out of range, and where the median is
/// asked for in a world that moves, or of a ray that is drawn.
void simulate(const DynamicWorld& world, const Options& options, size_t first_beam, BeamLog& beams);

/// Whether the keyframes of the world's model answer such beams near them: thin rays of the sensor
/// of its log, without `element_ids`, in a world of one model and of its movers.
bool keyframes_serve(const DynamicWorld& world, const Options& options, const LogInfo& beams);

using CachedReturns = std::vector<std::optional<keyframes::CachedReturn>>;

/// Draws the answers of keyframes to beams that an `EchoMaker` is to answer. There is one for each
/// beam, which is empty where the elements are to answer; there is none at all where not
/// `keyframes_serve`.
CachedReturns keyframe_answers(const DynamicWorld& world, const Options& options, size_t first_beam,
                               const BeamLog& beams);

/// A source that answers the beams of another source chunk by chunk. The world and the other source
/// must outlive it.
class SimulatedSource : public BeamSource {
 public:
  /// A function that answers beams in place. `first_beam` is the number of the first beam; the
  /// answer may have several rows per beam.
  using Answer = std::function<void(size_t first_beam, BeamLog& beams)>;

  /// If positive, `max_range_m` replaces the maximum range of the beams.
  SimulatedSource(Answer answer, BeamSource& beams, double max_range_m = 0);
  SimulatedSource(const trace::World& world, BeamSource& beams, const Options& options);
  const LogInfo& info() const override { return info_; }
  /// Sets `LogInfo::element_classes`.
  void name_classes(std::vector<std::string> names) { info_.element_classes = std::move(names); }
  /// The number of beams. There may be more rows.
  size_t size() const override { return beams_.size(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;

  /// Counts since the last rewind.
  size_t hits() const { return hits_; }
  size_t beams() const { return done_; }
  size_t rows() const { return rows_; }
  /// The time spent on answers without reading and writing, s.
  double seconds() const { return seconds_; }

 private:
  Answer answer_;
  BeamSource& beams_;
  LogInfo info_;
  size_t done_ = 0, hits_ = 0, rows_ = 0;
  double seconds_ = 0;
};

}  // namespace simulate
}  // namespace underbrush
