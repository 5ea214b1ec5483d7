#include "underbrush/sensor/scan_grid.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "underbrush/core/median.hpp"

namespace underbrush::sensor {
namespace {

using Complex = std::complex<double>;

constexpr size_t kMostAngles = size_t(1) << 14;  // of which the median is taken
constexpr double kWorstGridRad = 0.5 * M_PI / 180;

/// A point of a grid; zero without a return.
struct GridPoint {
  double x, y, z;
  Complex flat() const { return {x, y}; }
  double level() const { return std::sqrt(x * x + y * y); }
  double range() const { return std::sqrt(x * x + y * y + z * z); }
  bool is_hit() const { return range() > 0; }
};

/// The points of a scan by ring and column, which is the number of the firing.
struct ScanGrid {
  const double* xyz;
  GridShape shape;

  size_t rings() const { return shape.by_ring ? shape.rows : shape.columns; }
  size_t columns() const { return shape.by_ring ? shape.columns : shape.rows; }
  size_t column_step() const { return shape.by_ring ? 1 : shape.columns; }
  GridPoint point(size_t i) const {
    const double *const p = xyz + 3 * i, sum = p[0] + p[1] + p[2];
    return std::isfinite(sum) ? GridPoint{p[0], p[1], p[2]} : GridPoint{0, 0, 0};
  }
  /// Calls `visit(ring, column, index)` for all points in the order of memory.
  template <class Visit>
  void for_each(Visit visit) const {
    size_t i = 0;
    for (size_t a = 0; a < shape.rows; ++a) {
      for (size_t b = 0; b < shape.columns; ++b, ++i) {
        visit(shape.by_ring ? a : b, shape.by_ring ? b : a, i);
      }
    }
  }
};

/// Replaces the values that are not known by those between the known ones; beyond the last known
/// one they stay the same. At least one must be known.
template <class T>
void interpolate(std::vector<T>& values, const std::vector<bool>& known) {
  const auto first = size_t(std::find(known.begin(), known.end(), true) - known.begin());
  std::fill_n(values.begin(), first, values[first]);
  for (size_t from = first; from < values.size();) {
    size_t to = from + 1;
    while (to < values.size() && !known[to]) ++to;
    const T end = to < values.size() ? values[to] : values[from];
    for (size_t k = from + 1; k < to; ++k) {
      const double share = double(k - from) / double(to - from);
      values[k] = (1 - share) * values[from] + share * end;
    }
    from = to;
  }
}

/// The median angle from a column to the next, rad; nothing where no two neighbours have returns.
std::optional<double> column_angle(const ScanGrid& grid) {
  const auto both = [&](size_t c, size_t i) {
    return c > 0 && grid.point(i).is_hit() && grid.point(i - grid.column_step()).is_hit();
  };
  size_t pairs = 0;
  grid.for_each([&](size_t, size_t c, size_t i) { pairs += both(c, i); });
  if (pairs == 0) return {};
  const size_t one_in = 1 + pairs / kMostAngles;
  std::vector<double> steps;
  size_t pair = 0;
  grid.for_each([&](size_t, size_t c, size_t i) {
    if (!both(c, i) || pair++ % one_in != 0) return;
    steps.push_back(
        std::arg(grid.point(i).flat() * std::conj(grid.point(i - grid.column_step()).flat())));
  });
  return median(std::move(steps));
}

/// Elevations beyond the first and the last known ring go on with the slope of a line through all.
void extrapolate(std::vector<double>& elevation, const std::vector<bool>& known) {
  double n = 0, k = 0, e = 0, kk = 0, ke = 0;
  size_t first = elevation.size(), last = 0;
  for (size_t r = 0; r < elevation.size(); ++r) {
    if (!known[r]) continue;
    first = std::min(first, r), last = r;
    const auto x = double(r);
    ++n, k += x, e += elevation[r], kk += x * x, ke += x * elevation[r];
  }
  const double slope = (n * ke - k * e) / (n * kk - k * k);
  interpolate(elevation, known);
  for (size_t r = 0; r < first; ++r) elevation[r] -= slope * double(first - r);
  for (size_t r = last + 1; r < elevation.size(); ++r) elevation[r] += slope * double(r - last);
}

/// Azimuths as unit complex numbers, of each ring and of each column, whose product is a beam's,
/// and the elevations of the rings, rad. Hits are weighted by the squares of their ranges, because
/// lasers do not start at the origin.
struct GridAngles {
  std::vector<Complex> of_ring, of_column;
  std::vector<double> elevation;
};

std::optional<GridAngles> angles_of(const ScanGrid& grid) {
  const std::optional<double> step = column_angle(grid);
  const size_t rings = grid.rings(), columns = grid.columns();
  std::vector<bool> used(rings), seen(columns);
  GridAngles out{std::vector<Complex>(rings), std::vector<Complex>(columns),
                 std::vector<double>(rings)};
  if (!step) return {};
  std::vector<Complex> turned(columns);
  for (size_t c = 0; c < columns; ++c) turned[c] = std::polar(1.0, *step * double(c));
  std::vector<double> up(rings), along(rings);
  grid.for_each([&](size_t r, size_t c, size_t i) {
    const GridPoint p = grid.point(i);
    if (!p.is_hit()) return;
    used[r] = seen[c] = true;
    out.of_ring[r] += p.flat() * std::conj(turned[c]) * p.level();
    up[r] += p.z * p.range();
    along[r] += p.level() * p.range();
  });
  if (std::count(used.begin(), used.end(), true) < 2) return {};
  for (size_t r = 0; r < rings; ++r) {
    if (used[r]) out.of_ring[r] = std::polar(1.0, std::arg(out.of_ring[r]));
    out.elevation[r] = std::atan2(up[r], along[r]);
  }
  interpolate(out.of_ring, used);
  extrapolate(out.elevation, used);
  grid.for_each([&](size_t r, size_t c, size_t i) {
    const GridPoint p = grid.point(i);
    out.of_column[c] += p.flat() * std::conj(turned[c] * out.of_ring[r]) * p.level();
  });
  std::vector<double> rest(columns);
  for (size_t c = 0; c < columns; ++c) rest[c] = std::arg(out.of_column[c]);
  interpolate(rest, seen);
  for (size_t c = 0; c < columns; ++c) out.of_column[c] = turned[c] * std::polar(1.0, rest[c]);
  return out;
}

}  // namespace

bool grid_directions(const double* xyz, const GridShape& shape, double* direction) {
  const ScanGrid grid{xyz, shape};
  std::optional<GridAngles> angles = angles_of(grid);
  if (!angles) return false;
  std::vector<double> sine(grid.rings());
  for (size_t r = 0; r < sine.size(); ++r) {
    Complex& level = angles->of_ring[r];
    level *= std::cos(angles->elevation[r]) / std::abs(level);
    sine[r] = std::sin(angles->elevation[r]);
  }
  double error = 0, weight = 0;
  grid.for_each([&](size_t r, size_t c, size_t i) {
    const Complex level = angles->of_ring[r] * angles->of_column[c];
    double* const d = direction + 3 * i;
    d[0] = level.real(), d[1] = level.imag(), d[2] = sine[r];
    const GridPoint p = grid.point(i);
    const double range = p.range();
    const GridPoint off{d[0] * range - p.x, d[1] * range - p.y, d[2] * range - p.z};
    error += off.range() * range;
    weight += range * range;
  });
  return error <= kWorstGridRad * weight;
}

}  // namespace underbrush::sensor
