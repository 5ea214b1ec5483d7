#include "underbrush/primitives/adapt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "underbrush/core/check.hpp"

namespace underbrush::primitives {
namespace {

constexpr double kPriorReturns = 40;
constexpr double kMostFactor = 5;
constexpr double kTrust = 0.75;
constexpr double kMostStretch = 4, kLeastReachM = 0.02;
constexpr double kLeastGapM =
    1e-3;  // Places are known to the millimetre; nearer ones are moved apart.

/// Places apart from each other, upwards.
std::vector<double> rising(std::vector<double> places) {
  for (size_t k = 1; k < places.size(); ++k) {
    places[k] = std::max(places[k], places[k - 1] + kLeastGapM);
  }
  return places;
}

/// A rising map of one coordinate, linear between pairs of places and a shift beyond them.
class AxisMap {
 public:
  AxisMap(const std::vector<double>& from, const std::vector<double>& to)
      : from_(rising(from)), to_(rising(to)) {}
  double operator()(double x) const {
    if (x <= from_.front()) return x + to_.front() - from_.front();
    if (x >= from_.back()) return x + to_.back() - from_.back();
    const auto k = size_t(std::upper_bound(from_.begin(), from_.end(), x) - from_.begin());
    return to_[k - 1] + (x - from_[k - 1]) * (to_[k] - to_[k - 1]) / (from_[k] - from_[k - 1]);
  }

 private:
  std::vector<double> from_, to_;
};

/// Maps the places of a primitive to those of an object: heights by themselves, and x and y by
/// height, between the maps of the two layers beside it.
class BodyMap {
 public:
  BodyMap(const PrimitiveEntry& from, const PlacedObject& to)
      : z_(heights(from.box, from.layers), heights(to.box, to.layers)),
        middle_(rising(values(from.layers.z))) {
    for (size_t l = 0; l < middle_.size(); ++l) {
      x_.emplace_back(values(from.layers.x[l]), values(to.layers.x[l]));
      y_.emplace_back(values(from.layers.y[l]), values(to.layers.y[l]));
    }
  }
  Vec3 operator()(const Vec3& p) const {
    const auto above = size_t(std::ranges::upper_bound(middle_, p.z()) - middle_.begin());
    const size_t high = std::min(above, middle_.size() - 1), low = above > 0 ? above - 1 : 0;
    const double share = high > low ? (p.z() - middle_[low]) / (middle_[high] - middle_[low]) : 0;
    return {(1 - share) * x_[low](p.x()) + share * x_[high](p.x()),
            (1 - share) * y_[low](p.y()) + share * y_[high](p.y()), z_(p.z())};
  }
  /// The factors by which the surroundings of a place, as far as `reach_m`, are stretched along the
  /// axes.
  Vec3 stretch(const Vec3& p, const Vec3& reach_m) const {
    Vec3 out;
    for (int d = 0; d < 3; ++d) {
      const Vec3 reach = std::max(reach_m[d], kLeastReachM) * Vec3::Unit(d);
      const double wide = ((*this)(p + reach) - (*this)(p - reach))[d] / (2 * reach[d]);
      out[d] = std::clamp(wide, 1 / kMostStretch, kMostStretch);
    }
    return out;
  }

 private:
  static std::vector<double> values(const PointLayers::Places& places) {
    return {places.begin(), places.end()};
  }
  static std::vector<double> heights(const Box& box, const PointLayers& layers) {
    std::vector<double> out = values(layers.z);
    out.insert(out.begin(), box.min.z());
    out.push_back(box.max.z());
    return out;
  }

  AxisMap z_;
  std::vector<double> middle_;  // Heights of the layers of the primitive.
  std::vector<AxisMap> x_, y_;
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
  return from.layers.known() && to.layers.known();
}

elements::Model adapted(elements::Model model, const PrimitiveEntry& from, const PlacedObject& to) {
  require(can_adapt(from, to), "adapt: the places of the points are not known");
  const BodyMap moved(from, to);
  const std::array<double, 3> factors = matter_factors(from.beams, to.beams);
  for (Vec3f& v : model.surface.vertices) v = moved(v.cast<double>()).cast<float>();
  for (elements::Ellipsoid& e : model.ellipsoids) {
    const Vec3 from_m = e.mean.cast<double>(), to_m = moved(from_m);
    const Mat3 sigma = e.covariance_matrix();
    const Vec3 stretch = moved.stretch(from_m, sigma.diagonal().cwiseSqrt()).cwiseSqrt();
    e.set_covariance(stretch.asDiagonal() * sigma * stretch.asDiagonal());
    e.mean = to_m.cast<float>();
    const double up = (to_m.z() - to.box.min.z()) / to.box.size().z();
    const double f = factors[size_t(std::clamp(int(3 * up), 0, 2))];
    e.density_per_m *= float(f);
    e.hit.p = float(1 - std::pow(1 - double(e.hit.p), f));
  }
  return model;
}

}  // namespace underbrush::primitives
