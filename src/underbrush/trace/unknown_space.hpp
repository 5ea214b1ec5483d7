/// \file
/// The walk of a ray through space that no beam of the model's log crossed.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "underbrush/trace/crossed_cells.hpp"
#include "underbrush/trace/element_math.hpp"
#include "underbrush/trace/ground_heights.hpp"
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::trace {

/// The matter that rays are expected to meet in unknown space (`elements::ObservedSpace`). A ray is
/// followed in steps of the map's cells. In a step of length Δ in a cell that no beam crossed it
/// ends with the probability 1 − exp(−κ Δ).
class UnknownSpace {
 public:
  /// `space` and `ground` must outlive it. Where `ground` has no vertices to keep, all space counts
  /// as known.
  UnknownSpace(const elements::ObservedSpace& space, const elements::TriangleMesh& ground,
               const Vec3& origin, const std::vector<bool>& keep = {});

  /// A step in unknown space.
  struct Step {
    double from_m;  ///< Range of its beginning, m.
    double to_m;
    double height_m;  ///< Height of its middle above the ground, m.
    uint64_t cell;    ///< A hash of the cell of its middle.
    Vec3 at;          ///< Its middle in the frame of the model, m.
    double fall;      ///< Fall of the ray, m per metre, at least `kLeastFall`.

    /// Whether the ray is near the ground, where its fall counts and not its length.
    bool is_low() const { return height_m < elements::ObservedSpace::kGroundM; }
    /// The way (m) of the ray up to a range in the step, as densities count it.
    double way_m(double end_m) const { return (end_m - from_m) * (is_low() ? fall : 1); }
  };
  static constexpr double kLeastFall = 0.01;
  /// Calls `take(step)` for each step of a ray (world) in unknown space, in order of range, until
  /// it returns false. Steps above the highest interval in which there is matter are left out.
  template <class F>
  void follow(const Ray& ray, const RangeLimits& limits, F take) const {
    follow(
        ray, limits, [this](const StepCells& cells) { return ~crossed_.among(cells); }, take);
  }
  /// Does so with the steps that are among the bits of `which(cells)`.
  template <class Which, class F>
  void follow(const Ray& ray, const RangeLimits& limits, Which which, F take) const;
  const GroundHeights& ground() const { return ground_; }
  /// The height of a point (world, m) above the ground, m.
  double height(const Vec3& point) const {
    const Vec3 at = point - origin_;
    return at.z() - ground_.at(at.x(), at.y());
  }

  /// Draws the range (m) at which a ray ends in unknown space within limits; nothing where it does
  /// not. Rays of one key that come into one cell have the same trial there.
  std::optional<double> drawn_end(const Ray& ray, uint64_t key, const RangeLimits& limits) const;
  /// Draws the range, before that of the element at which the ray would end, which may be none.
  std::optional<double> drawn_end(const Ray& ray, uint64_t key, RangeLimits limits,
                                  const Intersection& met) const {
    if (!met.none()) limits.max_m = std::min(limits.max_m, met.t_m);
    return drawn_end(ray, key, limits);
  }
  /// Adds matter that a ray may meet in unknown space to the elements that it meets, in order of
  /// range: pieces of its way with their p, their mean range and its σ. They belong to no element.
  void add_to(const Ray& ray, const RangeLimits& limits, std::span<const Intersection> met,
              std::vector<Intersection>& out) const;

 private:
  /// What no step exceeds.
  struct Most {
    double height_m = elements::ObservedSpace::kHeightsM
                          .front();  ///< The greatest height of matter above the ground, m.
    double low_density = 0,
           high_density = 0;  ///< The greatest density near the ground and above it, 1/m.
  };

  static Most most_of(const elements::ObservedSpace& space);
  /// Whether a ray that comes near the ground has no return from there, by the trial of the cell
  /// where it first does.
  bool is_lost_low(const Ray& ray, uint64_t key, const RangeLimits& limits) const;
  /// The layers of cells in which a ray may end, above the cells of a column of blocks.
  CrossedCells::ColumnLayers matter_above(int32_t x, int32_t y) const;
  /// The optical depth of a step.
  double depth(const Step& step) const;
  /// The probability that a ray returns which comes near the ground in a step.
  double returns(const Step& step) const {
    const size_t r = elements::ObservedSpace::range_interval(0.5 * (step.from_m + step.to_m));
    return double(space_.ground_returns[r]) * ground_.share(step.at.x(), step.at.y());
  }

  const elements::ObservedSpace& space_;
  Vec3 origin_;
  GroundHeights ground_;
  Most most_;
  CrossedCells crossed_;
};

/// The element number of matter that a ray meets in unknown space.
inline constexpr uint32_t kUnknown = 0xfffffffeu;

/// The support of a beam: the probability that it does not end in unknown space, by the mixture of
/// its possible ranges.
double support_of(std::span<const Intersection> met, const RangeMixture& mixture);

template <class Which, class F>
void UnknownSpace::follow(const Ray& ray, const RangeLimits& limits, Which which, F take) const {
  if (ground_.empty()) return;
  const double cell = space_.cell_m;
  const Vec3 start = ray.origin - origin_;
  // The part of the ray between the lowest ground and the highest matter.
  double from = limits.min_m, to = limits.max_m;
  const double rise = ray.direction.z();
  const double low = ground_.lowest_m() + elements::ObservedSpace::kHeightsM.front() - 1;
  const double high = ground_.highest_m() + most_.height_m;
  if (std::abs(rise) > 1e-9) {
    const double a = (low - start.z()) / rise, b = (high - start.z()) / rise;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  } else if (start.z() < low || start.z() > high) {
    return;
  }
  // Most batches of steps lie in space that is known. Their ends are looked up first, in groups of
  // as many batches as there are steps in one.
  constexpr int kSteps = StepCells::kSteps;
  CrossedCells::Way way(crossed_, uint32_t(ray.direction.x() < 0) | uint32_t(ray.direction.y() < 0)
                                                                        << 1);
  StepCells cells, ends;
  const auto begin_of = [&](int step) { return from + step * cell; };
  for (int first = 0, place = 0; begin_of(first) < to; first += kSteps, ++place) {
    if (first == 0 || place == kSteps - 1) {
      const double length = kSteps * cell;
      cells_of_steps(start, ray.direction, begin_of(first) - 0.5 * length, length, cell, ends);
      place = 0;
    }
    if (way.surely_crossed(ends.of(place), ends.of(place + 1))) continue;
    cells_of_steps(start, ray.direction, begin_of(first), cell, cell, cells);
    // The last step may be shorter.
    int count = kSteps;
    if (!(begin_of(first + count - 1) + cell < to)) {
      count = 1;
      while (begin_of(first + count - 1) + cell < to) ++count;
      const double middle = 0.5 * (begin_of(first + count - 1) + to);
      cells.set(count - 1, cell_of(Vec3(start + middle * ray.direction), cell));
    }
    for (uint32_t left = which(cells) & ((1u << count) - 1); left != 0; left &= left - 1) {
      const int in_batch = std::countr_zero(left);
      const Cell3 c = cells.of(in_batch);
      const double t = begin_of(first + in_batch), end = std::min(t + cell, to);
      const Vec3 middle = start + 0.5 * (t + end) * ray.direction;
      const double height = middle.z() - ground_.at(middle.x(), middle.y());
      const Step step{t, end, height, CellHash()(c), middle, std::max(kLeastFall, -rise)};
      if (step.is_low() && ground_.is_known(middle.x(), middle.y())) continue;
      if (!take(step)) return;
    }
  }
}

}  // namespace underbrush::trace
