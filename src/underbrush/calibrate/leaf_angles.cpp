#include "underbrush/calibrate/leaf_angles.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/trace/unknown_space.hpp"

namespace underbrush::calibrate {
namespace {

constexpr double kCell = 1, kFarthest = 30;  // m
constexpr double kLeastShape = 0.01, kMostShape = 100;
constexpr double kWidest = 0.03;  // m, of a beam
constexpr double kBeamsUsed = 1 << 18;
constexpr size_t kInclinations = 40;  // intervals of |cos θ|
constexpr double kFewestReturns = 6;
// The least share of the variance of the returns along the direction in which it is least.
constexpr double kThinnest = 0.04;

/// What beams of similar inclinations met in a cell, of each half of the beams.
struct Bin {
  size_t index = 0;
  double chord_m = 0;  // through the cell, of all beams that came to it
  std::array<double, 2> path_m{}, returns{};
};

/// What beams met in a cell.
struct Cell {
  std::vector<Bin> bins;
  double count = 0;  // returns, and the sums of their places and products
  Vec3 sum = Vec3::Zero();
  Mat3 squares = Mat3::Zero();

  Bin& bin(size_t index) {
    for (Bin& b : bins) {
      if (b.index == index) return b;
    }
    return bins.emplace_back(Bin{index, 0, {}, {}});
  }
  void add_place(const Vec3& p) {
    count += 1;
    sum += p;
    squares += p * p.transpose();
  }
  /// Whether the returns fill space, as those of vegetation do.
  bool fills_space() const {
    if (count < kFewestReturns) return false;
    const Vec3 mean = sum / count;
    const Mat3 covariance = squares / count - mean * mean.transpose();
    const Vec3 principal = spectrum(covariance).values;
    return principal[0] > kThinnest * principal.sum();
  }
};

using Cells = std::unordered_map<Cell3, Cell, CellHash>;

size_t inclination_of(const Vec3& direction) {
  return std::min(kInclinations - 1, size_t(double(kInclinations) * std::abs(direction.z())));
}

/// Calls use(cell, from_m, exit_m) for each cell of the grid that a ray enters between two ranges.
template <class F>
void for_each_cell(const Ray& ray, double from_m, double to_m, F use) {
  Cell3 cell = cell_of(Vec3(ray.origin + from_m * ray.direction), kCell);
  int32_t* const at[3] = {&cell.x, &cell.y, &cell.z};
  double next[3], each[3];
  for (int k = 0; k < 3; ++k) {
    const double d = ray.direction[k];
    each[k] = d != 0 ? kCell / std::abs(d) : HUGE_VAL;
    next[k] = d != 0 ? (kCell * (*at[k] + (d > 0)) - ray.origin[k]) / d : HUGE_VAL;
  }
  while (from_m < to_m) {
    const int k = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    if (next[k] > from_m) use(cell, from_m, next[k]);
    from_m = std::max(from_m, next[k]);
    *at[k] += ray.direction[k] > 0 ? 1 : -1;
    next[k] += each[k];
  }
}

/// The range (m) up to which the beams of a log are narrow. The beams of an unknown sensor count as
/// narrow everywhere.
double narrow_to_m(const LogInfo& log) {
  if (log.sensor.empty()) return kFarthest;
  const sensor::BeamShape beam = sensor::sensor_of_log("log", log).beam;
  double range = kFarthest;
  const auto width = [&](double r) {
    const std::array half = beam.half_width_m(r);
    return 2 * std::max(half[0], half[1]);
  };
  while (range > 0 && width(range) > kWidest) range -= 0.5;
  return range;
}

/// Whether enough of the first beams of a log are within 45° of the vertical, and enough are not.
bool has_all_inclinations(BeamSource& log) {
  constexpr size_t kFirst = 1 << 16;
  constexpr double kFewest = 0.05;
  size_t beams = 0, steep = 0;
  BeamLog chunk;
  log.rewind();
  while (beams < kFirst && log.next(chunk)) {
    beams += chunk.size();
    for (const Vec3f& d : chunk.direction) steep += d.z() * d.z() > 0.5f;
  }
  const double share = double(steep) / std::max(1.0, double(beams));
  return share > kFewest && share < 1 - kFewest;
}

/// Counts the returns and the paths of a share of the beams of a log.
Cells cells_of(const elements::Model& model, BeamSource& log, double farthest, double min_range_m) {
  Cells out;
  const double share = std::min(1.0, kBeamsUsed / std::max(1.0, double(log.size())));
  const uint64_t below = uint64_t(share * 0x1p32);
  uint64_t number = 0;
  BeamLog chunk;
  log.rewind();
  while (log.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      const uint64_t random = mix64(number++);
      if (random >> 32 >= below) continue;
      const size_t half = random & 1;
      const double range = chunk.is_hit(i) ? double(chunk.range_m[i]) : HUGE_VAL;
      Ray ray = chunk.ray(i);
      ray.origin -= model.origin;
      const size_t inclination = inclination_of(ray.direction);
      for_each_cell(
          ray, min_range_m, std::min(range, farthest),
          [&](const Cell3& at, double from, double exit) {
            Cell& cell = out[at];
            Bin& bin = cell.bin(inclination);
            bin.chord_m += exit - from;
            bin.path_m[half] += std::min(exit, range) - from;
            if (range > exit) return;
            bin.returns[half] += 1;
            cell.add_place(ray.origin + range * ray.direction - kCell * Vec3(at.x, at.y, at.z));
          });
    }
  }
  return out;
}

/// The counts of the cells of vegetation, in the order of their places.
std::vector<Cell> vegetation_of(const Cells& cells, const elements::Model& model) {
  const trace::GroundHeights ground(model.ground, {});
  std::vector<std::pair<Cell3, const Cell*>> kept;
  for (const auto& [at, cell] : cells) {
    const double x = kCell * (at.x + 0.5), y = kCell * (at.y + 0.5);
    const bool above = ground.empty() || kCell * at.z > ground.at(x, y);
    if (above && cell.fills_space()) kept.emplace_back(at, &cell);
  }
  std::sort(kept.begin(), kept.end());
  std::vector<Cell> out;
  out.reserve(kept.size());
  for (const auto& [at, cell] : kept) out.push_back(*cell);
  return out;
}

/// The estimating function of ln χ, its negative derivative, and its variance: the sum of the
/// squares of what cells add to it.
struct Estimating {
  double value = 0, steepness = 0, squares = 0;
};

/// With the returns n and the weighted paths w = G L of the beams of one inclination of one half,
/// and the sums N and W over all inclinations of the other half, n W − N w is 0 on average, because
/// returns are ρ w on average and the halves are independent.
Estimating estimating_function(const std::vector<Cell>& cells, double ln_chi) {
  // ln G changes by χ² cos²θ / (χ² cos²θ + sin²θ) with ln χ, and by what is the same for all θ.
  std::array<double, kInclinations> weight, change;
  const double chi = std::exp(ln_chi);
  const LeafAngleDistribution leaves(chi);
  for (size_t k = 0; k < kInclinations; ++k) {
    const double cosine = (double(k) + 0.5) / kInclinations;
    const double upright = chi * chi * cosine * cosine;
    weight[k] = leaves.projection(cosine);
    change[k] = upright / (upright + 1 - cosine * cosine);
  }
  Estimating out;
  for (const Cell& c : cells) {
    double chords = 0, mean = 0, path[2] = {}, returns[2] = {};
    for (const Bin& b : c.bins) {
      const double w = weight[b.index];
      chords += w * b.chord_m;
      mean += w * b.chord_m * change[b.index];
      for (size_t half = 0; half < 2; ++half) {
        path[half] += w * b.path_m[half];
        returns[half] += b.returns[half];
      }
    }
    mean /= chords;
    double value = 0, steepness = 0;
    for (const Bin& b : c.bins) {
      const double from_mean = change[b.index] - mean;
      for (size_t half = 0; half < 2; ++half) {
        const double expected = returns[1 - half] * weight[b.index] * b.path_m[half];
        value += from_mean * (b.returns[half] * path[1 - half] - expected);
        steepness += from_mean * from_mean * expected;
      }
    }
    out.value += value / chords;
    out.steepness += steepness / chords;
    out.squares += value * value / (chords * chords);
  }
  return out;
}

/// Finds the root of the estimating function plus the slope of a normal prior of ln χ with mean 0
/// and standard deviation 1, whose part is `prior`, between bounds.
double root_of(const std::vector<Cell>& cells, double prior) {
  double low = std::log(kLeastShape), high = std::log(kMostShape);
  for (int k = 0; k < 30; ++k) {
    const double middle = 0.5 * (low + high);
    const bool below = estimating_function(cells, middle).value > prior * middle;
    (below ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

LeafAngleReport learn_leaf_angles(elements::Model& model, BeamSource& log, const LogInfo& info,
                                  double min_range_m) {
  LeafAngleReport out;
  model.leaf_angles = {};
  if (!info.has_misses || !has_all_inclinations(log)) return out;
  const double farthest = std::min({narrow_to_m(info), model.max_range_m, info.max_range_m});
  const std::vector<Cell> cells = vegetation_of(cells_of(model, log, farthest, min_range_m), model);
  out.cells = cells.size();
  for (const Cell& c : cells) out.hits += size_t(c.count);
  if (cells.empty()) return out;
  const Estimating spherical = estimating_function(cells, 0);
  if (!(spherical.squares > 0)) return out;
  out.deviation = spherical.value / std::sqrt(spherical.squares);
  out.chi = std::exp(root_of(cells, 0));
  out.used = std::abs(out.deviation) > 3;
  if (out.used) {
    const double prior = spherical.squares / spherical.steepness;
    model.leaf_angles = LeafAngleDistribution(std::exp(root_of(cells, prior)));
  }
  return out;
}

}  // namespace underbrush::calibrate
