#include "underbrush/metrics/clouds.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/metrics/nearest.hpp"

namespace underbrush::metrics {
namespace {

/// The points of a log, relative to a common origin.
struct Cloud {
  size_t beams = 0;
  std::array<size_t, 4> by_returns{};  // beams with none, one, two and more
  std::vector<Vec3f> point;
  std::vector<float> range_m;
};

/// Reads the points of a log; `progress(done)` is told the number of rows so far.
Cloud cloud_of(BeamSource& log, const Vec3& origin, const std::function<void(size_t)>& progress) {
  Cloud out;
  out.point.reserve(log.size());  // Memory that no point fills is never touched.
  out.range_m.reserve(log.size());
  size_t done = 0, returns = 0;
  const auto close = [&] {
    if (out.beams > 0) ++out.by_returns[std::min<size_t>(returns, 3)];
    returns = 0;
  };
  log.rewind();
  for (BeamLog chunk; log.next(chunk); done += chunk.size()) {
    progress(done);
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

/// The lowest real point of each square.
using Ground = CellMap<Cell2, float>;

Ground ground_of(const Cloud& real) {
  Ground out;
  for (const Vec3f& p : real.point) {
    const Cell2 square = cell_of(double(p.x()), double(p.y()), CloudScores::kGroundM);
    float& lowest = out.try_emplace(square, p.z()).first->second;
    lowest = std::min(lowest, p.z());
  }
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

LengthDistribution distribution_of(RealAndSimulated<std::vector<float>> values, double bin_m) {
  LengthDistribution out;
  out.bin_m = bin_m;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const std::vector<float>& of : values) {
    if (of.empty()) continue;
    const auto [least, most] = std::minmax_element(of.begin(), of.end());
    low = std::min(low, double(*least));
    high = std::max(high, double(*most));
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
  out.distance_m = wasserstein(std::move(values[0]), std::move(values[1]));
  return out;
}

double occupied(const RealAndSimulated<Cloud>& clouds) {
  CellMap<Cell3, uint8_t> sides;
  for (size_t side = 0; side < 2; ++side) {
    for (const Vec3f& p : clouds[side].point) {
      sides[cell_of(Vec3(p.cast<double>()), CloudScores::kCellM)] |= uint8_t(1 << side);
    }
  }
  const auto is_of_both = [](const auto& cell) { return cell.second == 3; };
  return double(std::count_if(sides.begin(), sides.end(), is_of_both)) / double(sides.size());
}

/// What a region has of the clouds.
struct RegionSums {
  RealAndSimulated<size_t> points{};
  RealAndSimulated<double> nearest_m{};
  RealAndSimulated<std::vector<float>> height_m;  // of the points above ground
};

using Regions = std::map<Cell2, RegionSums>;

/// Scores the distances of one cloud's points from the other one, and sums them up by region.
/// Returns the cloud's term of the density-aware Chamfer distance.
double score_side(const RealAndSimulated<Cloud>& clouds, size_t side, const Vec3& origin,
                  const Ground& ground, const std::function<void(size_t)>& progress,
                  CloudScores& out, Regions& regions) {
  const Cloud& cloud = clouds[side];
  out.beams[side] = cloud.beams;
  out.points[side] = cloud.point.size();
  for (size_t n = 0; n < cloud.by_returns.size(); ++n) {
    out.returns[side][n] = double(cloud.by_returns[n]) / double(cloud.beams);
  }
  const Nearest near = nearest(cloud.point, clouds[1 - side].point, progress);
  const std::vector<double> terms = chamfer_terms(near, clouds[1 - side].point.size());
  double sum = 0, misfit = 0;
  for (size_t i = 0; i < cloud.point.size(); ++i) {
    const double d = near.distance_m[i];
    sum += d;
    misfit += terms[i];
    const Vec3f& p = cloud.point[i];
    const Vec3 world = origin + p.cast<double>();
    RegionSums& region = regions[cell_of(world.x(), world.y(), CloudScores::kRegionM)];
    ++region.points[side];
    region.nearest_m[side] += d;
    const auto below = ground.find(cell_of(double(p.x()), double(p.y()), CloudScores::kGroundM));
    if (below != ground.end()) region.height_m[side].push_back(p.z() - below->second);
  }
  out.nearest_m[side] = sum / double(cloud.point.size());
  return misfit / double(cloud.point.size());
}

/// Scores the regions, and moves their heights into the distribution of all.
void score_regions(Regions& regions, CloudScores& out) {
  double all = 0;
  for (const auto& [at, sums] : regions) all += sums.nearest_m[0] + sums.nearest_m[1];
  RealAndSimulated<std::vector<float>> heights;
  for (auto& [at, sums] : regions) {
    CloudRegion& region = out.regions.emplace_back();
    region.at = at;
    region.points = sums.points;
    double error = 0, sides = 0;
    for (size_t side = 0; side < 2; ++side) {
      const std::vector<float>& own = sums.height_m[side];
      heights[side].insert(heights[side].end(), own.begin(), own.end());
      if (sums.points[side] == 0) continue;
      error += sums.nearest_m[side] / double(sums.points[side]);
      ++sides;
    }
    region.cloud_error_m = error / sides;
    if (all > 0) region.error_share = (sums.nearest_m[0] + sums.nearest_m[1]) / all;
    region.height_distance_m =
        wasserstein(std::move(sums.height_m[0]), std::move(sums.height_m[1]));
  }
  out.height = distribution_of(std::move(heights), 0.5);
}

}  // namespace

CloudScores compare_clouds(BeamSource& real, BeamSource& simulated,
                           const std::function<void(size_t, size_t)>& progress) {
  const std::optional<Vec3> origin = log_origin(real);
  require_data(origin.has_value(), "score: the real log is empty");
  const size_t rows = real.size() + simulated.size();  // There are at most as many points.
  const auto after = [&](size_t before) {
    return [&progress, before, rows](size_t done) {
      if (progress) progress(before + done, 2 * rows);
    };
  };
  RealAndSimulated<Cloud> clouds{cloud_of(real, *origin, after(0)),
                                 cloud_of(simulated, *origin, after(real.size()))};
  require_data(!clouds[0].point.empty(), "score: the real log has no return");
  require_data(!clouds[1].point.empty(), "score: the simulated log has no return");
  const Ground ground = ground_of(clouds[0]);
  CloudScores out;
  Regions regions;
  double chamfer = 0;
  for (size_t side = 0, done = rows; side < 2; done += clouds[side++].point.size()) {
    chamfer += score_side(clouds, side, *origin, ground, after(done), out, regions);
  }
  out.cloud_error_m = 0.5 * (out.nearest_m[0] + out.nearest_m[1]);
  out.density_aware_chamfer = 0.5 * chamfer;
  out.occupied = occupied(clouds);
  score_regions(regions, out);
  out.range = distribution_of({std::move(clouds[0].range_m), std::move(clouds[1].range_m)}, 1);
  return out;
}

}  // namespace underbrush::metrics
