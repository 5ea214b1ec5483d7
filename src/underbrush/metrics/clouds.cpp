#include "underbrush/metrics/clouds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/metrics/nearest.hpp"

namespace underbrush::metrics {
namespace {

constexpr float kNoHeight = NAN;

/// The points of a log, relative to a common origin.
struct Cloud {
  size_t beams = 0;
  std::array<size_t, 4> by_returns{};  // beams with none, one, two and more
  std::vector<Vec3f> point;
  std::vector<float> range_m;
  std::vector<float> height_m;  // kNoHeight where there is no ground
};

Cloud cloud_of(BeamSource& log, const Vec3& origin) {
  Cloud out;
  size_t returns = 0;
  const auto close = [&] {
    if (out.beams > 0) ++out.by_returns[std::min<size_t>(returns, 3)];
    returns = 0;
  };
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    const std::vector<bool> begins = begins_beam(chunk);
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (begins[i]) {
        close();
        ++out.beams;
      }
      if (!chunk.is_hit(i)) continue;
      ++returns;
      out.point.push_back((chunk.end_point(i) - origin).cast<float>());
      out.range_m.push_back(chunk.range_m[i]);
    }
  }
  close();
  return out;
}

Cell2 square_of(const Vec3f& p, double side_m) {
  return cell_of(double(p.x()), double(p.y()), side_m);
}

/// The lowest real point of each square.
using Ground = CellMap<Cell2, float>;

Ground ground_of(const Cloud& real) {
  Ground out;
  for (const Vec3f& p : real.point) {
    const auto [at, is_new] = out.try_emplace(square_of(p, CloudScores::kGroundM), p.z());
    if (!is_new) at->second = std::min(at->second, p.z());
  }
  return out;
}

void set_heights(const Ground& ground, Cloud& cloud) {
  for (const Vec3f& p : cloud.point) {
    const auto at = ground.find(square_of(p, CloudScores::kGroundM));
    cloud.height_m.push_back(at == ground.end() ? kNoHeight : p.z() - at->second);
  }
}

std::vector<float> known(const std::vector<float>& values) {
  std::vector<float> out;
  std::copy_if(values.begin(), values.end(), std::back_inserter(out),
               [](float x) { return !std::isnan(x); });
  return out;
}

/// ∫ |F − G| over the sorted values of both.
double wasserstein(std::vector<float> a, std::vector<float> b) {
  if (a.empty() || b.empty()) return kUnknown;
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double sum = 0, before = 0;
  for (size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    const bool is_a = j == b.size() || (i < a.size() && a[i] <= b[j]);
    const double at = is_a ? a[i] : b[j];
    const double f = double(i) / double(a.size()), g = double(j) / double(b.size());
    if (i + j > 0) sum += std::abs(f - g) * (at - before);
    before = at;
    is_a ? ++i : ++j;
  }
  return sum;
}

LengthDistribution distribution_of(const RealAndSimulated<std::vector<float>>& values,
                                   double bin_m) {
  LengthDistribution out;
  out.bin_m = bin_m;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const std::vector<float>& of : values) {
    for (const float x : of) {
      low = std::min(low, double(x));
      high = std::max(high, double(x));
    }
  }
  if (low > high) return out;
  constexpr double kMostBins = 10000;
  while ((high - low) / out.bin_m > kMostBins) out.bin_m *= 10;
  const double first = std::floor(low / out.bin_m);
  out.first_m = first * out.bin_m;
  const auto bins = size_t(std::floor(high / out.bin_m) - first) + 1;
  for (size_t side = 0; side < 2; ++side) {
    out.share[side].assign(bins, 0);
    for (const float x : values[side]) {
      const auto bin = size_t(std::floor(double(x) / out.bin_m) - first);
      out.share[side][std::min(bin, bins - 1)] += 1 / double(values[side].size());
    }
  }
  out.distance_m = wasserstein(values[0], values[1]);
  return out;
}

double occupied(const RealAndSimulated<Cloud>& clouds) {
  CellMap<Cell3, uint8_t> sides;
  for (size_t side = 0; side < 2; ++side) {
    for (const Vec3f& p : clouds[side].point) {
      sides[cell_of(Vec3(p.cast<double>()), CloudScores::kCellM)] |= uint8_t(1 << side);
    }
  }
  const auto both =
      std::count_if(sides.begin(), sides.end(), [](const auto& cell) { return cell.second == 3; });
  return double(both) / double(sides.size());
}

/// What a region has of the clouds.
struct RegionSums {
  RealAndSimulated<size_t> points{};
  RealAndSimulated<double> nearest_m{};
  RealAndSimulated<std::vector<float>> height_m;
};

}  // namespace

CloudScores compare_clouds(BeamSource& real, BeamSource& simulated) {
  const std::optional<Vec3> origin = log_origin(real);
  require_data(origin.has_value(), "score: the real log is empty");
  RealAndSimulated<Cloud> clouds{cloud_of(real, *origin), cloud_of(simulated, *origin)};
  require_data(!clouds[0].point.empty(), "score: the real log has no return");
  require_data(!clouds[1].point.empty(), "score: the simulated log has no return");
  const Ground ground = ground_of(clouds[0]);
  CloudScores out;
  std::map<Cell2, RegionSums> regions;
  double chamfer = 0;
  for (size_t side = 0; side < 2; ++side) {
    Cloud& cloud = clouds[side];
    set_heights(ground, cloud);
    out.beams[side] = cloud.beams;
    out.points[side] = cloud.point.size();
    for (size_t n = 0; n < cloud.by_returns.size(); ++n) {
      out.returns[side][n] = double(cloud.by_returns[n]) / double(cloud.beams);
    }
    const Nearest near = nearest(cloud.point, clouds[1 - side].point);
    const std::vector<double> terms = chamfer_terms(near, clouds[1 - side].point.size());
    double sum = 0, misfit = 0;
    for (size_t i = 0; i < cloud.point.size(); ++i) {
      const double d = near.distance_m[i];
      sum += d;
      misfit += terms[i];
      const Vec3f& p = cloud.point[i];
      const Vec3 world = *origin + p.cast<double>();
      RegionSums& region = regions[cell_of(world.x(), world.y(), CloudScores::kRegionM)];
      ++region.points[side];
      region.nearest_m[side] += d;
      if (!std::isnan(cloud.height_m[i])) region.height_m[side].push_back(cloud.height_m[i]);
    }
    out.nearest_m[side] = sum / double(cloud.point.size());
    chamfer += misfit / double(cloud.point.size());
  }
  out.cloud_error_m = 0.5 * (out.nearest_m[0] + out.nearest_m[1]);
  out.density_aware_chamfer = 0.5 * chamfer;
  out.occupied = occupied(clouds);
  out.range = distribution_of({clouds[0].range_m, clouds[1].range_m}, 1);
  out.height = distribution_of({known(clouds[0].height_m), known(clouds[1].height_m)}, 0.5);
  double all = 0;
  for (const auto& [at, sums] : regions) all += sums.nearest_m[0] + sums.nearest_m[1];
  for (const auto& [at, sums] : regions) {
    CloudRegion& region = out.regions.emplace_back();
    region.at = at;
    region.points = sums.points;
    double error = 0, sides = 0;
    for (size_t side = 0; side < 2; ++side) {
      if (sums.points[side] == 0) continue;
      error += sums.nearest_m[side] / double(sums.points[side]);
      ++sides;
    }
    region.cloud_error_m = error / sides;
    if (all > 0) region.error_share = (sums.nearest_m[0] + sums.nearest_m[1]) / all;
    region.height_distance_m = wasserstein(sums.height_m[0], sums.height_m[1]);
  }
  return out;
}

}  // namespace underbrush::metrics
