/// \file
/// The main job: beams in, ranges out.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/sensor/beam.hpp"
#include "underbrush/simulate/dynamic_world.hpp"

namespace underbrush {
/// Beams answered by a world.
namespace simulate {

/// How the range is drawn when a beam ends at an ellipsoid.
enum class RangeDraw {
  kOnRay,  ///< t ~ N(t_i, σ_i²): the Gaussian constrained to the ray, [deschaud12] eq. 2–3.
  kVolumetric,  ///< A point from N(μ, Σ), [tallavajhula18] §IV: it may lie off the beam.
};

/// Options of `simulate`.
struct Options {
  uint64_t seed = 1;
  RangeDraw draw = RangeDraw::kOnRay;
  double range_noise_m = 0;  ///< σ of further noise on every range.
  double max_range_m = 0;    ///< Overrides the largest range of the beams if positive.
  bool element_ids = false;  ///< Add the extra columns `element` and `element_class`.
  /// Of a scene, one an instance: with `element_ids` `element_class` is taken from here instead of
  /// from the element, and there is a column `instance`, 0 for the ground and where nothing was
  /// hit.
  std::vector<elements::Class> instance_labels{};
  /// The ray that is traced, drawn from this shape about each beam's axis ([deschaud12] §IV); the
  /// direction in the log stays that of the axis. Unset: the axis itself.
  std::optional<sensor::BeamShape> random_ray{};
};

/// Answers beams in place: the range of each becomes that of the first element which accepts it, or
/// a miss. Beam i draws its random numbers from (seed, scan, first_beam + i), so neither chunks nor
/// threads change the answer. Volumetric draws also turn the direction towards the point drawn.
/// Elements count at ranges within those of `beams.info` (or `options.max_range_m`) and up to the
/// `max_range_m` of the model of instance 0, which in a composed scene is the ground: the other
/// models' limits are not looked at. A draw outside these limits is put at the element itself.
/// Intensities are those of no instrument: 0 (`EchoMaker` has one).
void simulate(const DynamicWorld& world, const Options& options, size_t first_beam, BeamLog& beams);

/// The beams of a source, answered chunk by chunk. World and source must outlive it.
class SimulatedSource : public BeamSource {
 public:
  /// Answers beams in place, of which the first has this number; may make several rows of a beam.
  using Answer = std::function<void(size_t first_beam, BeamLog& beams)>;

  /// A positive `max_range_m` overrides that of the beams.
  SimulatedSource(Answer answer, BeamSource& beams, double max_range_m = 0);
  SimulatedSource(const trace::World& world, BeamSource& beams, const Options& options);
  const LogInfo& info() const override { return info_; }
  /// Of the beams; rows may be more.
  size_t size() const override { return beams_.size(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;

  /// Since the last rewind.
  size_t hits() const { return hits_; }
  size_t beams() const { return done_; }
  size_t rows() const { return rows_; }
  /// Time spent answering (s), reading and writing apart.
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
