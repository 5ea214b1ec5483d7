#include "underbrush/perception/free_area.hpp"

#include <cmath>
#include <optional>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {
namespace {

// How far the cells along a direction are free, m.
double reach(const OccupancyGrid& grid, const Vec3& from, const Vec3& direction,
             const FreeAreaOptions& options) {
  const double step = grid.cell_m() / 2;
  const size_t most = 2 * grid.columns();
  std::optional<size_t> last;
  for (size_t k = 1; k <= most; ++k) {
    const double r = double(k) * step;
    const Vec3 p = from + r * direction;
    const auto cell = grid.cell_at(p.x(), p.y());
    if (!cell) return double(k - 1) * step;
    if (cell == last || r < options.own_vehicle_m) continue;
    if (grid.probability(*cell)[0] < options.free_probability) return double(k - 1) * step;
    last = cell;
  }
  return double(most) * step;
}

}  // namespace

void FreeAreaOptions::check() const {
  require(bearings >= 3 && bearings <= 3600, "free area: 3 to 3600 bearings");
  require(free_probability >= 0 && free_probability <= 1 && own_vehicle_m >= 0,
          "free area: the probability or the vehicle's reach is out of range");
}

void find_free_area(const OccupancyGrid& grid, const Pose& world_from_vehicle,
                    const FreeAreaOptions& options, std::vector<Vec3>& outline) {
  outline.clear();
  for (uint32_t k = 0; k < options.bearings; ++k) {
    const double angle = 2 * M_PI * k / options.bearings;
    const Vec3 d = world_from_vehicle.rotation * Vec3(std::cos(angle), std::sin(angle), 0);
    outline.emplace_back(world_from_vehicle.translation +
                         reach(grid, world_from_vehicle.translation, d, options) * d);
  }
}

}  // namespace underbrush::perception
