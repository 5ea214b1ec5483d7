#include "studies/transmission.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::studies {

double SlabAnswer::largest_layer_error(double truth) const {
  double largest = 0;
  for (size_t z = 1; z + 1 < layer.size(); ++z) {
    // A NaN stays, so that a layer without a density does not hold.
    const double off = std::abs(layer[z] / truth - 1);
    if (!(off <= largest)) largest = off;
    if (std::isnan(largest)) break;
  }
  return largest;
}

SlabAnswer densities_of(const std::function<double(int x, int y, int z)>& density,
                        const SlabCells& measured) {
  constexpr size_t kLeastBeams = 50;
  constexpr double kCells = (kEndInner - kFirstInner) * (kEndInner - kFirstInner);
  SlabAnswer out;
  double sum = 0;
  size_t known = 0, judged = 0, covered = 0;
  for (int z = 0; z < SlabCells::kHeight; ++z) {
    double sum_of_layer = 0;
    size_t known_in_layer = 0;
    for (int y = kFirstInner; y < kEndInner; ++y) {
      for (int x = kFirstInner; x < kEndInner; ++x) {
        const double value = density(x, y, z);
        if (std::isfinite(value)) {
          sum_of_layer += value;
          ++known_in_layer;
        }
        const CellSums& cell = measured.at(x, y, z);
        if (cell.beams < kLeastBeams) continue;
        ++judged;
        covered += cell.interval_holds(value);
      }
    }
    out.layer[size_t(z)] = sum_of_layer / double(known_in_layer);
    sum += sum_of_layer;
    known += known_in_layer;
  }
  out.area_density = sum / double(known);
  out.covered = double(covered) / double(judged);
  out.opaque = 1 - double(known) / (kCells * SlabCells::kHeight);
  return out;
}

std::vector<Check> slab_checks(const std::string& slab, const SlabAnswer& answer,
                               const SlabAnswer& truth) {
  const auto error = [](double value, double of) { return std::abs(value / of - 1); };
  const size_t overhead = size_t(SlabView::kOverhead);
  return {
      {slab + ", error of the area density", error(answer.area_density, truth.area_density), 0.05},
      {slab + ", largest error of a layer", answer.largest_layer_error(truth.area_density), 0.05},
      {slab + ", error of the transmission from overhead",
       error(answer.transmission[overhead], truth.transmission[overhead]), 0.1}};
}

}  // namespace underbrush::studies
