#include "underbrush/calibrate/channels.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::calibrate {
namespace {

constexpr size_t kBlock = 256;  // beams of a long log that are taken or left together
constexpr size_t kCellsOfTask = 1 << 11;
constexpr size_t kFewestPoints = 20;  // of a flat cell
constexpr long kFewestRings = 5;      // of a flat cell
constexpr int kFewestCells = 10;      // of a ring with an offset
constexpr double kThickestM = 0.03;   // standard deviation across a flat cell
constexpr double kLeastCosine = 0.3;  // of a beam with the normal
constexpr double kMeanPrior = 0.01;   // precision of the offsets' mean against that of one ring
constexpr double kSignificant = 3;    // standard errors

struct Point {
  uint16_t ring;
  Vec3f at, direction;  // m, relative to the log's origin
};

std::vector<Point> points_of(BeamSource& log, const ChannelOptions& o) {
  const std::optional<Vec3> origin = log_origin(log);
  std::vector<Point> points;
  if (!origin) return points;
  const size_t every = (log.size() + o.most_points - 1) / o.most_points;
  size_t row = 0;
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i, ++row) {
      if (!chunk.is_hit(i) || row / kBlock % every != 0) continue;
      const double range = chunk.range_m[i];
      if (range < o.min_range_m || range > o.max_range_m) continue;
      const Vec3 at = chunk.end_point(i) - *origin;
      points.push_back({chunk.ring[i], at.cast<float>(), chunk.direction[i]});
    }
  }
  return points;
}

/// The numbers of the points in order of the cells of a grid, then rings, then the log's order, and
/// where each cell begins; the last entry of `begin` is the end.
struct Grid {
  std::vector<uint32_t> order, begin;
};

// The grid whose cells begin at `shift_m` on each axis.
Grid grid_of(const std::vector<Point>& points, double side_m, double shift_m) {
  // A key has the cell's x and y in its first word, and z, ring and the point's number in the
  // second one. Cells are numbered from those of the least coordinates, so that every number fits.
  constexpr int kBitsOfPoint = 28, kBitsOfRing = 10, kBitsOfHeight = 26;
  const auto cell_at = [&](const Point& p) {
    return cell_of(p.at.cast<double>() - Vec3::Constant(shift_m), side_m);
  };
  Cell3 least{};
  for (size_t i = 0; i < points.size(); ++i) {
    const Cell3 c = cell_at(points[i]);
    if (i == 0) least = c;
    least = {std::min(least.x, c.x), std::min(least.y, c.y), std::min(least.z, c.z)};
  }
  std::vector<std::array<uint64_t, 2>> keys(points.size());
  parallel_for(points.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Cell3 c = cell_at(points[i]);
      const uint64_t x = uint32_t(c.x) - uint32_t(least.x), y = uint32_t(c.y) - uint32_t(least.y);
      const uint64_t z = std::min(uint32_t(c.z) - uint32_t(least.z), (1u << kBitsOfHeight) - 1);
      keys[i] = {x << 32 | y,
                 z << (kBitsOfRing + kBitsOfPoint) | uint64_t(points[i].ring) << kBitsOfPoint | i};
    }
  });
  sort_keys(keys);
  Grid grid;
  const auto height = [](const std::array<uint64_t, 2>& key) {
    return key[1] >> (kBitsOfRing + kBitsOfPoint);
  };
  for (size_t i = 0; i < keys.size(); ++i) {
    const bool is_first =
        i == 0 || keys[i][0] != keys[i - 1][0] || height(keys[i]) != height(keys[i - 1]);
    if (is_first) grid.begin.push_back(uint32_t(i));
    grid.order.push_back(uint32_t(keys[i][1] & ((uint64_t(1) << kBitsOfPoint) - 1)));
  }
  grid.begin.push_back(uint32_t(keys.size()));
  return grid;
}

/// The mean of the returns of a ring in a flat cell.
struct Observation {
  uint16_t ring;
  double weight;
  double off_m, cosine;  // along the normal: the distance from the plane, and of a unit of range
  Vec3 on_plane;         // 1 and the place on the plane, m
};

// The observations of a cell; none where it is not flat.
std::vector<Observation> observations_of(const std::vector<Point>& points,
                                         std::span<const uint32_t> cell,
                                         const std::vector<double>& offset, double thickest_m) {
  if (cell.size() < kFewestPoints) return {};
  const auto place = [&](const Point& p) -> Vec3 {
    return p.at.cast<double>() - offset[p.ring] * p.direction.cast<double>();
  };
  Vec3 mean = Vec3::Zero();
  for (const uint32_t p : cell) mean += place(points[p]);
  mean /= double(cell.size());
  Mat3 spread = Mat3::Zero();
  for (const uint32_t p : cell) {
    const Vec3 from_mean = place(points[p]) - mean;
    spread += from_mean * from_mean.transpose();
  }
  const auto [values, axes] = quick_spectrum(spread / double(cell.size()));
  const Vec3 variance = values.cwiseMax(0);
  const bool flat = variance[0] < thickest_m * thickest_m && variance[1] > 0.05 * 0.05 &&
                    variance[0] < 0.1 * variance[1];
  if (!flat) return {};
  const double farthest = 3 * std::max(std::sqrt(variance[0]), 0.005);
  std::vector<Observation> out;
  for (size_t i = 0; i < cell.size();) {
    const uint16_t ring = points[cell[i]].ring;
    Observation sum{ring, 0, 0, 0, Vec3::Zero()};
    for (; i < cell.size() && points[cell[i]].ring == ring; ++i) {
      const Point& p = points[cell[i]];
      const Vec3 at = axes.transpose() * (place(p) - mean);
      const double cosine = axes.col(0).dot(p.direction.cast<double>());
      if (std::abs(cosine) < kLeastCosine || std::abs(at[0]) > farthest) continue;
      sum.weight += 1;
      sum.off_m += at[0];
      sum.cosine += cosine;
      sum.on_plane += Vec3(1, at[1], at[2]);
    }
    if (sum.weight == 0) continue;
    const double n = sum.weight;
    // Noise falls with the number of returns, the unevenness of the surface does not.
    out.push_back({ring, n / (n + 2), sum.off_m / n, sum.cosine / n, sum.on_plane / n});
  }
  return long(out.size()) < kFewestRings ? std::vector<Observation>() : out;
}

/// The normal equations of the offsets, with the planes eliminated.
struct Equations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  std::vector<int> cells;  // flat cells that each ring was seen in
  double squares = 0, freedom = 0;

  explicit Equations(size_t rings)
      : matrix(Eigen::MatrixXd::Zero(long(rings), long(rings))),
        right(Eigen::VectorXd::Zero(long(rings))),
        cells(rings) {}

  void add(const std::vector<Observation>& cell) {
    Mat3 plane = 1e-9 * Mat3::Identity();
    Vec3 moment = Vec3::Zero();
    for (const Observation& o : cell) {
      plane += o.weight * o.on_plane * o.on_plane.transpose();
      moment += o.weight * o.off_m * o.on_plane;
    }
    const Mat3 inverse = plane.inverse();
    const Vec3 fitted = inverse * moment;
    for (const Observation& a : cell) {
      const double rest = a.off_m - a.on_plane.dot(fitted);
      const Vec3 leverage = inverse * a.on_plane;
      right[a.ring] += a.weight * a.cosine * rest;
      squares += a.weight * rest * rest;
      ++cells[a.ring];
      matrix(a.ring, a.ring) += a.weight * a.cosine * a.cosine;
      for (const Observation& b : cell) {
        matrix(a.ring, b.ring) -=
            a.weight * b.weight * a.cosine * b.cosine * leverage.dot(b.on_plane);
      }
    }
    freedom += double(cell.size()) - 3;
  }
  void add(const Equations& other) {
    matrix += other.matrix;
    right += other.right;
    for (size_t i = 0; i < cells.size(); ++i) cells[i] += other.cells[i];
    squares += other.squares;
    freedom += other.freedom;
  }
};

Equations equations_of(const std::vector<Point>& points, const std::vector<Grid>& grids,
                       const std::vector<double>& offset, double thickest_m) {
  Equations out(offset.size());
  for (const Grid& grid : grids) {
    const std::span<const uint32_t> order = grid.order;
    const size_t cells = grid.begin.size() - 1;
    std::vector<Equations> parts((cells + kCellsOfTask - 1) / kCellsOfTask,
                                 Equations(offset.size()));
    parallel_for(cells, kCellsOfTask, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const size_t count = grid.begin[k + 1] - grid.begin[k];
        const auto cell =
            observations_of(points, order.subspan(grid.begin[k], count), offset, thickest_m);
        if (!cell.empty()) parts[begin / kCellsOfTask].add(cell);
      }
    });
    for (const Equations& part : parts) out.add(part);
  }
  return out;
}

// The offsets of the rings that were seen often enough, about their mean, and its standard errors.
ChannelOffsets about_mean(const std::vector<double>& offset, const Eigen::MatrixXd& covariance,
                          const std::vector<int>& cells) {
  ChannelOffsets out;
  double mean = 0, mean_variance = 0;
  for (size_t i = 0; i < offset.size(); ++i) {
    if (cells[i] < kFewestCells) continue;
    out.push_back({uint16_t(i), offset[i], 0});
    mean += offset[i];
  }
  const double n = double(out.size());
  const auto with_mean = [&](const ChannelOffset& o) {
    double sum = 0;
    for (const ChannelOffset& other : out) sum += covariance(o.ring, other.ring);
    return sum / n;
  };
  for (const ChannelOffset& o : out) mean_variance += with_mean(o) / n;
  for (ChannelOffset& o : out) {
    const double variance = covariance(o.ring, o.ring) - 2 * with_mean(o) + mean_variance;
    o.range_m -= mean / n;
    o.standard_error_m = std::sqrt(std::max(0.0, variance));
  }
  return out;
}

}  // namespace

ChannelOffsets learn_offsets(BeamSource& log, const ChannelOptions& options) {
  require(
      options.cell_m > 0 && options.prior_m > 0 && options.rounds > 0 && options.most_points > 0,
      "learn_offsets: an option is out of range");
  const std::vector<Point> points = points_of(log, options);
  size_t rings = 0;
  for (const Point& p : points) rings = std::max(rings, size_t(p.ring) + 1);
  if (rings < size_t(kFewestRings) || rings > 1024) return {};
  const double prior = 1 / (options.prior_m * options.prior_m);
  // Rings that meet at the border of two cells meet within a cell of the other grid.
  const std::vector<Grid> grids{grid_of(points, options.cell_m, 0),
                                grid_of(points, options.cell_m, options.cell_m / 2)};
  std::vector<double> offset(rings);
  Eigen::MatrixXd covariance;
  std::vector<int> cells;
  for (int round = 0; round < options.rounds; ++round) {
    const Equations e = equations_of(points, grids, offset, (round == 0 ? 2 : 1) * kThickestM);
    if (!(e.squares > 0) || e.freedom < double(rings)) return {};
    // Both grids have the same points, which count once.
    const double precision = e.freedom / e.squares / double(grids.size());
    cells = e.cells;
    Eigen::MatrixXd matrix = precision * e.matrix;
    Eigen::VectorXd right = precision * e.right;
    // The prior is about the mean, which has a weak prior of its own: surfaces that were measured
    // at several angles determine it, but badly, and without that prior it would pass into the
    // others.
    const double n = double(rings);
    const Eigen::Map<const Eigen::VectorXd> at(offset.data(), long(rings));
    matrix.diagonal().array() += prior;
    matrix.array() -= (1 - kMeanPrior) * prior / n;
    right.array() -= prior * (at.array() - (1 - kMeanPrior) * at.mean());
    covariance = inverse(matrix);
    const Eigen::VectorXd step = covariance * right;
    for (size_t i = 0; i < rings; ++i) offset[i] += step[long(i)];
  }
  ChannelOffsets out = about_mean(offset, covariance, cells);
  const OffsetSpread spread = spread_of(out);
  if (long(out.size()) < kFewestRings || spread.sigma_m < kSignificant * spread.standard_error_m) {
    return {};
  }
  return out;
}

}  // namespace underbrush::calibrate
