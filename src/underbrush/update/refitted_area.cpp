#include "underbrush/update/refitted_area.hpp"

#include <cmath>

#include "underbrush/fit/tile_fit.hpp"

namespace underbrush::update {

credit::GroundArea refitted_area(const elements::Model& model, const std::vector<uint32_t>& before,
                                 const std::vector<TileKey>& anew, double tile_m) {
  const auto corner = [&](TileKey key) { return Eigen::Vector2d(key.i * tile_m, key.j * tile_m); };
  const Eigen::Vector2d side(tile_m, tile_m);
  Eigen::Vector2d low = corner(anew.front()), high = low;
  for (const TileKey key : anew) {
    low = low.cwiseMin(corner(key) - side);
    high = high.cwiseMax(corner(key) + 2 * side);
  }
  credit::GroundArea area(low, high);
  for (const TileKey key : anew) area.add(corner(key), corner(key) + side);
  for (size_t k = 0; k < before.size(); ++k) {
    if (before[k] != fit::kNewEllipsoid) continue;
    const elements::Ellipsoid& e = model.ellipsoids[k];
    const Eigen::Vector2d mean = e.mean.head<2>().cast<double>();
    const Eigen::Vector2d reach =
        model.tau * Eigen::Vector2d(std::sqrt(e.covariance[0]), std::sqrt(e.covariance[3]));
    area.add(mean - reach, mean + reach);
  }
  return area;
}

}  // namespace underbrush::update
