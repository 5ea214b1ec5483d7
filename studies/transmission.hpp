/// \file
/// The test of matter that is learnt from a log: a model of a turbid slab beside the slab.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "studies/plain_density.hpp"
#include "studies/study.hpp"

namespace underbrush::studies {

/// The cells inside a slab that are judged, 18 m along x and y: the coordinates [first, end).
inline constexpr int kFirstInner = 11, kEndInner = 29;

/// The densities, cells and transmissions of a slab by one source, or the true ones.
struct SlabAnswer {
  double area_density = 0;                         ///< m²/m³; mean of the inner cells.
  std::array<double, SlabCells::kHeight> layer{};  ///< Means by layer, upwards.
  /// Share of the inner cells reached by at least 50 beams whose 95 % interval holds the density;
  /// NaN for the densities of the interval itself.
  double covered = 0;
  double opaque = 0;  ///< Share of the inner cells without a density, because nothing passes them.
  std::array<double, std::size(kSlabViews)> transmission{};  ///< Share of the beams, by view.
  std::array<double, std::size(kSlabViews)> error{};  ///< The truth's standard error; 0 for others.

  /// The layer whose density is farthest from `truth`, in parts of it, without the lowest and the
  /// highest layer.
  double largest_layer_error(double truth) const;
};

/// Returns an answer without transmissions, from the density of each cell of the slab (m²/m³; NaN
/// where nothing passes). `measured` are the cells of the log.
SlabAnswer densities_of(const std::function<double(int x, int y, int z)>& density,
                        const SlabCells& measured);

/// Returns the thresholds, for the default: area density within 5 % of the truth, on average and in
/// each layer but the lowest and the highest, and transmission from overhead within 10 %.
std::vector<Check> slab_checks(const std::string& slab, const SlabAnswer& answer,
                               const SlabAnswer& truth);

}  // namespace underbrush::studies
