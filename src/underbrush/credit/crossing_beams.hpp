/// \file
/// The beams of a log that cross some places or miss some ellipsoids, and several logs as one.
#pragma once
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::credit {

/// A part of the ground plane, in cells of 4 m.
class GroundArea {
 public:
  /// An empty area that can hold places between `low` and `high` (m, x and y).
  GroundArea(const Eigen::Vector2d& low, const Eigen::Vector2d& high);
  /// Adds the cells that a box touches; places beyond the area's bounds are left out.
  void add(const Eigen::Vector2d& low, const Eigen::Vector2d& high);
  /// Whether the way from `from` by `step` touches a cell of the area, seen from above (m).
  bool is_crossed(const Eigen::Vector2d& from, const Eigen::Vector2d& step) const;

 private:
  Eigen::Vector2d low_;
  int columns_, rows_;
  std::vector<uint8_t> in_;
};

/// The beams of a log that cross an area of a model's frame, up to `beyond_m` (m) behind their
/// returns.
class CrossingBeams : public BeamSource {
 public:
  /// `source` and `area` must outlive it; `origin` is that of the model. Beams without a return end
  /// at `max_range_m` or at the log's largest range.
  CrossingBeams(BeamSource& source, const GroundArea& area, const Vec3& origin, double max_range_m,
                double beyond_m)
      : source_(source),
        area_(area),
        origin_(origin),
        max_range_m_(max_range_m),
        beyond_m_(beyond_m) {}
  const LogInfo& info() const override { return source_.info(); }
  /// The number of beams of the source.
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamLog crossing(const BeamLog& chunk) const;

  BeamSource& source_;
  const GroundArea& area_;
  Vec3 origin_;
  double max_range_m_, beyond_m_;
};

/// Whether each ray meets an element of a world up to its reach (m).
std::vector<uint8_t> meet_something(const trace::World& world, std::span<const Ray> rays,
                                    std::span<const double> reach_m);

/// The beams of a log that meet none of some ellipsoids up to `beyond_m` (m) behind their returns.
class BeamsBeside : public BeamSource {
 public:
  /// `model` has the ellipsoids and nothing else. Both must outlive the beams.
  BeamsBeside(BeamSource& source, const elements::Model& model, double beyond_m)
      : source_(source), world_(model), beyond_m_(beyond_m) {}
  const LogInfo& info() const override { return source_.info(); }
  /// The number of beams of the source.
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  trace::World world_;
  double beyond_m_;
};

/// Several logs, one after another, with the facts of the last one.
class JoinedBeams : public BeamSource {
 public:
  /// The sources, at least one, must outlive it.
  explicit JoinedBeams(std::vector<BeamSource*> sources) : sources_(std::move(sources)) {}
  const LogInfo& info() const override { return sources_.back()->info(); }
  size_t size() const override;
  void rewind() override;
  bool next(BeamLog& chunk) override;

 private:
  std::vector<BeamSource*> sources_;
  size_t at_ = 0;
};

}  // namespace underbrush::credit
