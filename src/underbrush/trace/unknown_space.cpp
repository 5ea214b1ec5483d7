#include "underbrush/trace/unknown_space.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::trace {

using elements::ObservedSpace;

UnknownSpace::UnknownSpace(const ObservedSpace& space, const elements::TriangleMesh& ground,
                           const Vec3& origin, const std::vector<bool>& keep)
    : space_(space),
      origin_(origin),
      ground_(ground, keep, space.lost),
      most_(most_of(space)),
      crossed_(space, [this](int32_t x, int32_t y) { return matter_above(x, y); }) {}

UnknownSpace::Most UnknownSpace::most_of(const ObservedSpace& space) {
  Most out;
  for (size_t h = 0; h < ObservedSpace::kHeights; ++h) {
    const auto& row = space.density_per_m[h];
    if (std::all_of(row.begin(), row.end(), [](float x) { return x == 0; })) continue;
    out.height_m = h < ObservedSpace::kHeightsM.size() ? ObservedSpace::kHeightsM[h] : HUGE_VAL;
    out.height_m = std::min(out.height_m, space.top_m);
    const bool is_low = h < ObservedSpace::height_interval(ObservedSpace::kGroundM);
    double& density = is_low ? out.low_density : out.high_density;
    density = std::max(density, double(*std::ranges::max_element(row)));
  }
  return out;
}

CrossedCells::ColumnLayers UnknownSpace::matter_above(int32_t x, int32_t y) const {
  constexpr double kSlackM = 1e-6;  // for rounding
  constexpr size_t kSide = elements::ObservedBlock::kSide;
  const double cell = space_.cell_m;
  const auto layer = [cell](double z_m) {
    return int32_t(std::floor(std::clamp(z_m / cell, -1e9, 1e9)));
  };
  CrossedCells::ColumnLayers out;
  out.fill({INT32_MIN, INT32_MAX});
  if (ground_.empty()) return out;
  // The layers are those of two by two cells, which are hardly more than those of each.
  for (size_t j = 0; j < kSide; j += 2) {
    const auto along_y = ground_.along_y((y + int32_t(j)) * cell, 2 * cell);
    for (size_t i = 0; i < kSide; i += 2) {
      const auto along_x = ground_.along_x((x + int32_t(i)) * cell, 2 * cell);
      const auto [low, high] = ground_.bounds(along_x, along_y);
      CrossedCells::Layers with{INT32_MIN, layer(high + most_.height_m + kSlackM)};
      if (ground_.is_known(along_x, along_y)) {
        with.first = layer(low + ObservedSpace::kGroundM - kSlackM);
      }
      for (const size_t row : {j, j + 1}) out[row * kSide + i] = out[row * kSide + i + 1] = with;
    }
  }
  return out;
}

double UnknownSpace::depth(const Step& s) const {
  if (s.height_m > most_.height_m) return 0;
  const size_t h = ObservedSpace::height_interval(s.height_m),
               r = ObservedSpace::range_interval(0.5 * (s.from_m + s.to_m));
  return double(space_.density_per_m[h][r]) * s.way_m(s.to_m);
}

double support_of(std::span<const Intersection> met, const RangeMixture& mixture) {
  double unknown = 0;
  for (size_t k = 0; k < mixture.components.size(); ++k) {
    if (met[k].element == kUnknown) unknown += mixture.components[k].weight;
  }
  return std::max(0.0, 1 - unknown);
}

std::optional<double> UnknownSpace::drawn_end(const Ray& ray, uint64_t key,
                                              const RangeLimits& limits) const {
  constexpr double kSlack = 1 + 1e-9;  // for rounding
  std::optional<double> end;
  const auto ends = [&](const Step& s, double of_step) {
    if (!(of_step > 0)) return false;
    const double u = drawn_in_cell(key, s.cell, 0);
    if (u > kSlack * of_step) return false;  // as −ln(1 − u) ≥ u
    // The place in the step of an exponential distribution, given that it ends in the step.
    const double free = -std::log1p(-u);
    if (free >= of_step) return false;
    end = s.from_m + (s.to_m - s.from_m) * free / of_step;
    return true;
  };
  // Most steps pass, which follows from their draws alone. To draw for all steps of a batch takes
  // less than to look their cells up, if few draws are small.
  const double density =
      std::max(most_.high_density, most_.low_density * std::max(kLeastFall, -ray.direction.z()));
  double most = kSlack * density * space_.cell_m;
  constexpr double kFew = 0.2;
  const auto may_end = [&](const StepCells& cells) {
    return most < kFew ? crossed_.without(drawn_at_most(most, key, cells), cells)
                       : ~crossed_.among(cells);
  };
  std::optional<bool> is_lost;  // whether the ray has no return from near the ground
  follow(ray, limits, may_end, [&](const Step& s) {
    if ((s.is_low() && is_lost.value_or(false)) || !ends(s, depth(s))) return true;
    if (s.is_low() && !is_lost) is_lost = is_lost_low(ray, key, limits);
    if (!s.is_low() || !*is_lost) return false;
    end.reset();
    most = kSlack * most_.high_density * space_.cell_m;
    return true;
  });
  return end;
}

bool UnknownSpace::is_lost_low(const Ray& ray, uint64_t key, const RangeLimits& limits) const {
  bool out = false;
  follow(ray, limits, [&](const Step& s) {
    if (s.is_low()) out = drawn_in_cell(key, s.cell, 1) >= returns(s);
    return !s.is_low();
  });
  return out;
}

void UnknownSpace::add_to(const Ray& ray, const RangeLimits& limits,
                          std::span<const Intersection> met, std::vector<Intersection>& out) const {
  constexpr double kLongest = 0.15;  // of the range
  constexpr double kDeepest = 0.3, kNegligible = 1e-4;
  out.clear();
  double deep = 0, first = 0, sum = 0, squares = 0, through = 1;
  size_t next = 0;
  RangeLimits open = limits;  // up to where the elements stop nearly all rays
  for (const Intersection& m : met) {
    if ((through *= 1 - m.p) > kNegligible) continue;
    open.max_m = std::min(open.max_m, m.t_m);
    break;
  }
  through = 1;
  const auto elements_before = [&](double t_m) {
    for (; next < met.size() && met[next].t_m < t_m; ++next) out.push_back(met[next]);
  };
  // Near the ground: the probability of a return, and that of no end so far if it returns.
  bool is_low = false, piece_is_low = false;
  double returning = 1, left = 1;
  const auto finish = [&] {
    if (deep > 0) {
      Intersection piece;
      piece.t_m = sum / deep;
      piece.sigma_m = std::sqrt(std::max(0.0, squares / deep - piece.t_m * piece.t_m));
      const double ended = -std::expm1(-deep);
      piece.p = ended;
      if (piece_is_low) {
        piece.p = returning * left * ended / (1 - returning * (1 - left));
        left *= 1 - ended;
      }
      piece.element = kUnknown;
      elements_before(piece.t_m);
      out.push_back(piece);
      through *= 1 - piece.p;
    }
    deep = sum = squares = 0;
  };
  follow(ray, open, [&](const Step& s) {
    if (s.is_low() != piece_is_low) finish();
    piece_is_low = s.is_low();
    if (piece_is_low && !is_low) {
      is_low = true;
      returning = std::min(returns(s), 1 - kNegligible);
    }
    const double middle = 0.5 * (s.from_m + s.to_m), length = s.to_m - s.from_m;
    if (deep > 0 && (deep > kDeepest || s.to_m - first > std::max(1.0, kLongest * middle)))
      finish();
    const double of_step = depth(s);
    if (deep == 0) first = s.from_m;
    deep += of_step;
    sum += of_step * middle;
    squares += of_step * (middle * middle + length * length / 12);
    return through > kNegligible;
  });
  finish();
  elements_before(HUGE_VAL);
}

}  // namespace underbrush::trace
