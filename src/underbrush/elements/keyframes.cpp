#include "underbrush/elements/keyframes.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::elements {
namespace {

/// Computes the angles of two points (x, y) in (−π, π] with an error below 10⁻⁵ rad, the same on
/// every machine. The loops have no branches, so that both angles are computed at once.
std::array<double, 2> angles_of(const std::array<double, 2>& x, const std::array<double, 2>& y) {
  std::array<double, 2> out;
  for (size_t k = 0; k < 2; ++k) {
    const double a = std::abs(x[k]), b = std::abs(y[k]);
    const double most = std::max(a, b), q = std::min(a, b) / std::max(most, DBL_MIN), s = q * q;
    // Abramowitz and Stegun 4.4.49: an error of at most 2·10⁻⁸ · q.
    double r =
        q *
        (1 +
         s * (-0.3333314528 +
              s * (0.1999355085 +
                   s * (-0.1420889944 +
                        s * (0.1065626393 +
                             s * (-0.0752896400 +
                                  s * (0.0429096138 + s * (-0.0161657367 + s * 0.0028662257))))))));
    r = b > a ? M_PI / 2 - r : r;
    r = x[k] < 0 ? M_PI - r : r;
    out[k] = y[k] < 0 ? -r : r;
  }
  return out;
}

constexpr double kSlotsARow = 8;  // slots of the table of rows, for each row

bool sums_to_one(double sum) { return std::abs(sum - 1) < 1e-6; }

void check_weights(const KeyframeWeights& t) {
  double weights = t.elements, scales = 0;
  bool ok = t.elements >= 0;
  for (const double w : t.pixel) weights += w, ok &= w >= 0;
  for (const double c : t.scale) scales += c, ok &= c >= 0;
  for (const double s : t.sigma_m) ok &= std::isfinite(s) && s > 0;
  ok &= sums_to_one(weights) && (sums_to_one(scales) || weights == t.elements);
  require(ok, "keyframes: the weights of a situation are not those of a mixture");
}

}  // namespace

void Keyframes::check() const {
  require(!elevation.empty() && columns > 0 && pixels() < (size_t(1) << 30),
          "keyframes: the image has no pixels or too many");
  require(std::is_sorted(elevation.begin(), elevation.end()) &&
              std::abs(elevation.front()) <= M_PI / 2 && std::abs(elevation.back()) <= M_PI / 2,
          "keyframes: the rows' elevations are not ascending angles");
  require(channel.empty() || channel.size() == rows(),
          "keyframes: another number of channels than of rows");
  require(
      std::isfinite(unit_m) && unit_m > 0 && std::isfinite(intensity_unit) && intensity_unit >= 0,
      "keyframes: a unit is not positive");
  for (const Keyframe& f : frames) {
    require(f.origin.allFinite() && std::abs(f.sensor_from_world.norm() - 1) < 1e-6,
            "keyframes: the pose of a keyframe is not finite");
    require(f.column_origin.size() == columns && f.pixels.size() == pixels(),
            "keyframes: a keyframe has another number of pixels");
    for (const Vec3f& o : f.column_origin) {
      require(o.allFinite(), "keyframes: an origin is not finite");
    }
  }
  for (const KeyframeWeights& t : weights) check_weights(t);
}

size_t agreement(const double* range_m, size_t count) {
  size_t misses = 0;
  double least = HUGE_VAL, most = 0;
  for (size_t k = 0; k < count; ++k) {
    if (std::isinf(range_m[k])) {
      ++misses;
      continue;
    }
    least = std::min(least, range_m[k]);
    most = std::max(most, range_m[k]);
  }
  if (misses == count) return 0;
  if (misses > 0) return 2 * misses > count ? 1 : 2;
  const double apart = most - least;
  return apart < 0.15 ? 3 : apart < 0.5 ? 4 : apart < 2 ? 5 : 6;
}

KeyframeGrid::KeyframeGrid(const Keyframes& k)
    : elevation_(k.elevation),
      columns_a_rad_(double(k.columns) / (2 * M_PI)),
      first_(k.elevation.front()),
      columns_(double(k.columns)) {
  const double span = std::max(k.elevation.back() - first_, 1e-6);
  const size_t slots = size_t(kSlotsARow * double(k.rows())) + 1;
  per_rad_ = double(slots) / span;
  for (size_t s = 0; s <= slots; ++s) {
    const double angle = first_ + double(s) / per_rad_;
    const auto above = std::upper_bound(elevation_.begin(), elevation_.end(), angle);
    row_below_.push_back(uint32_t(std::max<ptrdiff_t>(above - elevation_.begin(), 1) - 1));
  }
}

KeyframeGrid::Place KeyframeGrid::place(const Vec3& d) const {
  const double flat = std::sqrt(d.x() * d.x() + d.y() * d.y());
  const auto [elevation, azimuth] = angles_of({flat, d.x()}, {d.z(), d.y()});
  double column = azimuth * columns_a_rad_;
  if (column < 0) column += columns_;
  if (column >= columns_) column = 0;
  const double last = elevation_.back();
  const size_t rows = elevation_.size();
  // Half the step beyond the outermost rows still belongs to them.
  const double low_step = rows > 1 ? elevation_[1] - first_ : 0.02;
  const double high_step = rows > 1 ? last - elevation_[rows - 2] : 0.02;
  if (elevation < first_ - low_step || elevation > last + high_step) return {-1, column};
  if (elevation <= first_) return {0.5 - 0.5 * (first_ - elevation) / low_step, column};
  if (elevation >= last) {
    return {double(rows) - 0.5 + 0.49 * (elevation - last) / high_step, column};
  }
  size_t row = row_below_[size_t((elevation - first_) * per_rad_)];
  while (row + 1 < rows && elevation_[row + 1] <= elevation) ++row;
  while (row > 0 && elevation_[row] > elevation) --row;
  const double step = elevation_[row + 1] - elevation_[row];
  const double part = step > 0 ? (elevation - elevation_[row]) / step : 0;
  return {double(row) + 0.5 + part, column};
}

double KeyframeGrid::elevation(double row) const {
  const double at = std::clamp(row - 0.5, 0.0, double(elevation_.size() - 1));
  const size_t r = std::min(size_t(at), elevation_.size() - 1);
  const size_t next = std::min(r + 1, elevation_.size() - 1);
  return elevation_[r] + (at - double(r)) * (elevation_[next] - elevation_[r]);
}

}  // namespace underbrush::elements
