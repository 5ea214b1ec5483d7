#include "underbrush/primitives/adapt.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::primitives {
namespace {

constexpr double kPriorReturns = 40;
constexpr double kMostFactor = 5;
constexpr double kTrust = 0.75;
constexpr double kLeastGapM =
    1e-3;  // Places are known to the millimetre; nearer ones are moved apart.

bool has_quantiles(const std::array<Vec3, 5>& quantiles) {
  return quantiles != PlacedObject{}.quantiles;
}

/// A rising map of one coordinate, linear between pairs of places and a shift beyond them.
class AxisMap {
 public:
  AxisMap(const Box& box, const std::array<Vec3, 5>& quantiles, const PlacedObject& to, int axis)
      : from_(places(box, quantiles, axis)), to_(places(to.box, to.quantiles, axis)) {}
  double operator()(double x) const {
    if (x <= from_.front()) return x + to_.front() - from_.front();
    if (x >= from_.back()) return x + to_.back() - from_.back();
    const auto k = size_t(std::upper_bound(from_.begin(), from_.end(), x) - from_.begin());
    return to_[k - 1] + (x - from_[k - 1]) * (to_[k] - to_[k - 1]) / (from_[k] - from_[k - 1]);
  }

 private:
  using Places = std::array<double, 7>;
  static Places places(const Box& box, const std::array<Vec3, 5>& quantiles, int axis) {
    Places out{box.min[axis]};
    for (size_t q = 0; q < quantiles.size(); ++q) out[q + 1] = quantiles[q][axis];
    out.back() = box.max[axis];
    for (size_t k = 1; k < out.size(); ++k) out[k] = std::max(out[k], out[k - 1] + kLeastGapM);
    return out;
  }
  Places from_, to_;
};

/// The factors of the optical depth by thirds of the height.
std::array<double, 3> matter_factors(const BoxBeams& from, const BoxBeams& to) {
  std::array<double, 3> f{1, 1, 1}, expected{};
  if (!from.known() || !to.known()) return f;
  double returns = 0, all_expected = 0;
  for (size_t t = 0; t < 3; ++t) {
    if (from.path_m[t] > 0) expected[t] = from.returns[t] / from.path_m[t] * to.path_m[t];
    returns += to.returns[t];
    all_expected += expected[t];
  }
  const double all = (returns + kPriorReturns) / (all_expected + kPriorReturns);
  for (size_t t = 0; t < 3; ++t) {
    f[t] = (to.returns[t] + kPriorReturns * all) / (expected[t] + kPriorReturns);
    f[t] = std::pow(std::clamp(f[t], 1 / kMostFactor, kMostFactor), kTrust);
  }
  return f;
}

}  // namespace

bool can_adapt(const PrimitiveEntry& from, const PlacedObject& to) {
  return has_quantiles(from.quantiles) && has_quantiles(to.quantiles);
}

elements::Model adapted(elements::Model model, const PrimitiveEntry& from, const PlacedObject& to) {
  require(can_adapt(from, to), "adapt: the quantiles of the points are not known");
  const std::array<AxisMap, 3> maps{AxisMap(from.box, from.quantiles, to, 0),
                                    AxisMap(from.box, from.quantiles, to, 1),
                                    AxisMap(from.box, from.quantiles, to, 2)};
  const auto move = [&](Vec3f& p) {
    for (int d = 0; d < 3; ++d) p[d] = float(maps[size_t(d)](double(p[d])));
  };
  const std::array<double, 3> factors = matter_factors(from.beams, to.beams);
  for (Vec3f& v : model.surface.vertices) move(v);
  for (elements::Ellipsoid& e : model.ellipsoids) {
    move(e.mean);
    const double up = (double(e.mean.z()) - to.box.min.z()) / to.box.size().z();
    const double f = factors[size_t(std::clamp(int(3 * up), 0, 2))];
    e.density_per_m *= float(f);
    e.hit.p = float(1 - std::pow(1 - double(e.hit.p), f));
  }
  return model;
}

}  // namespace underbrush::primitives
