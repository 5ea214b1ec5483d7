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

UnknownSpace::UnknownSpace(const ObservedSpace& space, const elements::TriangleMesh& ground,
                           const Vec3& origin, const std::vector<bool>& keep)
    : space_(space), origin_(origin), crossed_(space), ground_(ground, keep, space.lost) {
  top_m_ = ObservedSpace::kHeightsM.front();
  for (size_t h = 0; h < ObservedSpace::kHeights; ++h) {
    const auto& row = space.density_per_m[h];
    if (std::all_of(row.begin(), row.end(), [](float x) { return x == 0; })) continue;
    top_m_ = h < ObservedSpace::kHeightsM.size() ? ObservedSpace::kHeightsM[h] : HUGE_VAL;
    top_m_ = std::min(top_m_, space.top_m);
    double& most =
        h < ObservedSpace::height_interval(ObservedSpace::kGroundM) ? most_low_ : most_high_;
    most = std::max(most, double(*std::ranges::max_element(row)));
  }
}

double UnknownSpace::depth(const Step& s) const {
  if (s.height_m > top_m_) return 0;
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
  // Most rays pass, which follows from their draws alone. Only a ray that may end near the ground
  // is followed again, because it has one trial where it first comes there.
  bool comes_low = false;
  const double density = std::max(most_high_, most_low_ * std::max(kLeastFall, -ray.direction.z()));
  const double most = kSlack * density * space_.cell_m;
  // To draw for all steps of a batch takes less than to look their cells up, if few draws are
  // small.
  constexpr double kFew = 0.2;
  const auto may_end = [&](const StepCells& cells, CrossedCells::Block& block) {
    if (most < kFew) return drawn_at_most(most, key, cells);
    return crossed_.hold(cells, block) ? 0u : ~0u;
  };
  follow(ray, limits, may_end, [&](const Step& s) {
    comes_low = s.is_low();
    return !comes_low && !ends(s, depth(s));
  });
  if (!comes_low) return end;
  bool is_low = false, is_lost = false;
  follow(ray, limits, [&](const Step& s) {
    if (s.is_low() && !is_low) {
      is_low = true;
      is_lost = drawn_in_cell(key, s.cell, 1) >= returns(s);
    }
    return !ends(s, s.is_low() && is_lost ? 0 : depth(s));
  });
  return end;
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
