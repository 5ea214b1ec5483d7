#include "underbrush/sites/distances.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/cells.hpp"

namespace underbrush::sites {
namespace {

constexpr double kSearchCellM = 4;
constexpr double kSamePlaceM = 1e-6;

}  // namespace

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? NAN : sum / double(values.size());
}

double deviation_of(std::span<const double> values) {
  const double middle = mean_of(values);
  double sum = 0;
  for (const double v : values) sum += (v - middle) * (v - middle);
  return values.size() < 2 ? NAN : std::sqrt(sum / double(values.size() - 1));
}

std::vector<double> nearest_distances(std::span<const Eigen::Vector2d> from,
                                      std::span<const Eigen::Vector2d> to) {
  CellMap<Cell2, std::vector<Eigen::Vector2d>> buckets;
  Eigen::AlignedBox2d bounds;
  for (const Eigen::Vector2d& p : to) {
    buckets[cell_of(p.x(), p.y(), kSearchCellM)].push_back(p);
    bounds.extend(p);
  }
  std::vector<double> out;
  for (const Eigen::Vector2d& p : from) {
    double nearest = std::numeric_limits<double>::infinity();
    const Cell2 home = cell_of(p.x(), p.y(), kSearchCellM);
    const double farthest =
        to.empty() ? 0 : bounds.exteriorDistance(p) + bounds.sizes().norm() + 2 * kSearchCellM;
    // Rings of buckets around the place: none beyond ring r is nearer than r sides.
    for (int32_t r = 0; kSearchCellM * (r - 1) <= std::min(nearest, farthest); ++r) {
      for (int32_t y = -r; y <= r; ++y) {
        for (int32_t x = -r; x <= r; x += std::abs(y) == r || r == 0 ? 1 : 2 * r) {
          const auto found = buckets.find(Cell2{home.x + x, home.y + y});
          if (found == buckets.end()) continue;
          for (const Eigen::Vector2d& other : found->second) {
            const double d = (other - p).norm();
            if (d > kSamePlaceM) nearest = std::min(nearest, d);
          }
        }
      }
    }
    out.push_back(nearest);
  }
  return out;
}

}  // namespace underbrush::sites
