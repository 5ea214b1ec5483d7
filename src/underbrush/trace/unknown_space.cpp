#include "underbrush/trace/unknown_space.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::trace {

using elements::ObservedSpace;

// long: heights and shares are of the same cells.
GroundHeights::GroundHeights(const elements::TriangleMesh& ground, const std::vector<bool>& keep,
                             std::span<const elements::LostBeams> lost) {
  constexpr double kMarginM = 128, kMostCells = 1 << 22;  // the margin lies around the ground
  const auto kept = [&](size_t i) { return keep.empty() || keep[i]; };
  const auto cell = [&](size_t i) {
    const Vec3f& v = ground.vertices[i];
    return cell_of(double(v.x()), double(v.y()), side_m_);
  };
  Vec3f low = Vec3f::Constant(HUGE_VALF), high = -low;
  for (size_t i = 0; i < ground.vertices.size(); ++i) {
    if (!kept(i)) continue;
    low = low.cwiseMin(ground.vertices[i]);
    high = high.cwiseMax(ground.vertices[i]);
  }
  if (low.x() > high.x()) return;
  const auto along = [&](int axis) {
    return double(high[axis] - low[axis]) / side_m_ + 2 + 2 * kMarginM / side_m_;
  };
  while (along(0) * along(1) > kMostCells) side_m_ *= 2;
  const auto margin = int32_t(kMarginM / side_m_);
  const Cell2 first = cell_of(double(low.x()), double(low.y()), side_m_),
              last = cell_of(double(high.x()), double(high.y()), side_m_);
  low_ = {first.x - margin, first.y - margin};
  nx_ = last.x - first.x + 1 + 2 * margin;
  ny_ = last.y - first.y + 1 + 2 * margin;
  const size_t cells = size_t(nx_) * size_t(ny_);
  std::vector<double> sum(cells), count(cells);
  for (size_t i = 0; i < ground.vertices.size(); ++i) {
    if (!kept(i)) continue;
    const Cell2 c = cell(i);
    const size_t k = size_t(c.y - low_.y) * size_t(nx_) + size_t(c.x - low_.x);
    sum[k] += double(ground.vertices[i].z());
    ++count[k];
  }
  height_m_.resize(cells);
  known_.resize(cells);
  lowest_m_ = HUGE_VAL, highest_m_ = -HUGE_VAL;
  std::vector<size_t> front;
  for (size_t k = 0; k < cells; ++k) {
    if (count[k] == 0) continue;
    height_m_[k] = float(sum[k] / count[k]);
    known_[k] = 1;
    lowest_m_ = std::min(lowest_m_, double(height_m_[k]));
    highest_m_ = std::max(highest_m_, double(height_m_[k]));
    front.push_back(k);
  }
  extend(height_m_, front);
  if (lost.empty()) return;
  share_.resize(cells);
  for (const size_t k : front) share_[k] = 1;
  for (const elements::LostBeams& l : lost) {
    const double side = ObservedSpace::kSquareM;
    const Cell2 c = cell_of((l.at.x + 0.5) * side, (l.at.y + 0.5) * side, side_m_);
    const int32_t x = c.x - low_.x, y = c.y - low_.y;
    if (x < 0 || y < 0 || x >= nx_ || y >= ny_) continue;
    const size_t k = size_t(y) * size_t(nx_) + size_t(x);
    if (count[k] > 0) continue;
    if (share_[k] == 0) front.push_back(k);
    share_[k] = float(1 / (1.0 + l.beams));
  }
  extend(share_, std::move(front));
}

void GroundHeights::extend(std::vector<float>& values, std::vector<size_t> front) const {
  std::vector<uint8_t> is_known(values.size()), sources(values.size());
  for (const size_t k : front) is_known[k] = 1;
  while (!front.empty()) {
    std::vector<size_t> next;
    for (const size_t k : front) {
      const int32_t x = int32_t(k % size_t(nx_)), y = int32_t(k / size_t(nx_));
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= nx_ || y + dy >= ny_) continue;
        const size_t n = size_t(y + dy) * size_t(nx_) + size_t(x + dx);
        if (is_known[n]) continue;
        if (sources[n]++ == 0) next.push_back(n);
        values[n] += values[k];
      }
    }
    for (const size_t n : next) {
      values[n] /= float(sources[n]);
      is_known[n] = 1;
    }
    front = std::move(next);
  }
}

std::optional<double> GroundHeights::entry(const Ray& ray, const RangeLimits& limits,
                                           double step_m) const {
  if (empty() || !(ray.direction.z() < 0)) return {};
  const double from = (highest_m_ - ray.origin.z()) / ray.direction.z();
  const double lowest = (lowest_m_ - ray.origin.z()) / ray.direction.z();
  const double to = std::min(limits.max_m, lowest);
  for (double t = std::max(limits.min_m, from); t < to; t += step_m) {
    const Vec3 p = ray.origin + t * ray.direction;
    if (p.z() < at(p.x(), p.y())) return t;
  }
  if (lowest < limits.max_m) return std::max(limits.min_m, lowest);
  return {};
}

double GroundHeights::between(const std::vector<float>& values, double x, double y) const {
  const double u = std::clamp(x / side_m_ - 0.5 - low_.x, 0.0, double(nx_ - 1) - 1e-9);
  const double v = std::clamp(y / side_m_ - 0.5 - low_.y, 0.0, double(ny_ - 1) - 1e-9);
  const int32_t i = int32_t(u), j = int32_t(v);
  const double a = u - i, b = v - j;
  const float* row = &values[size_t(j) * size_t(nx_) + size_t(i)];
  return (1 - b) * ((1 - a) * double(row[0]) + a * double(row[1])) +
         b * ((1 - a) * double(row[nx_]) + a * double(row[nx_ + 1]));
}

std::array<double, 2> GroundHeights::bounds(double x, double y, double side_m) const {
  const auto node = [&](double at, int32_t low, int32_t count) {
    return int32_t(std::clamp(at / side_m_ - 0.5 - low, 0.0, double(count - 1) - 1e-9));
  };
  const int32_t last_i = node(x + side_m, low_.x, nx_) + 1,
                last_j = node(y + side_m, low_.y, ny_) + 1;
  std::array<double, 2> out{HUGE_VAL, -HUGE_VAL};
  for (int32_t j = node(y, low_.y, ny_); j <= last_j; ++j) {
    for (int32_t i = node(x, low_.x, nx_); i <= last_i; ++i) {
      const auto height = double(height_m_[size_t(j) * size_t(nx_) + size_t(i)]);
      out = {std::min(out[0], height), std::max(out[1], height)};
    }
  }
  return out;
}

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

CrossedCells::Layers UnknownSpace::matter_above(int32_t x, int32_t y) const {
  constexpr double kSlackM = 1e-6;  // for rounding
  const auto layer = [this](double z_m) {
    return int32_t(std::floor(std::clamp(z_m / space_.cell_m, -1e9, 1e9)));
  };
  CrossedCells::Layers out{INT32_MIN, INT32_MAX};
  if (ground_.empty()) return out;
  const double cell = space_.cell_m, x_m = x * cell, y_m = y * cell;
  const auto [low, high] = ground_.bounds(x_m, y_m, cell);
  out.last = layer(high + most_.height_m + kSlackM);
  const auto is_known = [&](double dx, double dy) { return ground_.is_known(x_m + dx, y_m + dy); };
  if (is_known(0, 0) && is_known(cell, 0) && is_known(0, cell) && is_known(cell, cell)) {
    out.first = layer(low + ObservedSpace::kGroundM - kSlackM);
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
