#include "underbrush/ground/height_grid.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <cmath>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/ground/node_mask.hpp"

namespace underbrush::ground {
namespace {

/// The couplings of half a row of the symmetric matrix: a node's coefficients with itself and with
/// the nodes that follow it row by row. Points contribute to the first five, bending to all seven.
enum Coupling { kSelf, kEast, kNorth, kNorthEast, kNorthWest, kEast2, kNorth2, kCouplings };
constexpr int kStep[kCouplings][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {-1, 1}, {2, 0}, {0, 2}};

/// Returns the coupling that leads by (dx, dy); dy > 0, or dy = 0 and dx ≥ 0.
constexpr int coupling_of(int dx, int dy) {
  for (int c = 0; c < kCouplings; ++c) {
    if (kStep[c][0] == dx && kStep[c][1] == dy) return c;
  }
  return -1;
}

/// Normal equations of the points at one node: Σ w wᵀ and Σ w z.
struct NodeSums {
  double a[5] = {}, b = 0;
  void operator+=(const NodeSums& o) {
    for (int c = 0; c < 5; ++c) a[c] += o.a[c];
    b += o.b;
  }
};

/// The sums of a block's cells reach one node beyond the block to the north and to the east.
constexpr int kSumSide = kBlockSide + 1;
using BlockSums = std::array<NodeSums, kSumSide * kSumSide>;

using Matrix = Eigen::SparseMatrix<double>;  // lower triangle
using Coefficients = std::vector<std::array<double, kCouplings>>;

}  // namespace

struct HeightGrid::Sums {
  Vec3 origin;
  HeightGridOptions options;
  std::map<BlockKey, BlockSums> blocks;
  size_t n = 0;
  double z = 0, zz = 0;

  NodeMask nodes() const;
};

HeightGrid::HeightGrid(const Vec3& origin, const HeightGridOptions& options)
    : sums_(new Sums{origin, options, {}, 0, 0, 0}) {
  require(options.spacing_m > 0 && options.smoothness_m2 > 0 && options.padding_m >= 0 &&
              options.bridge_m >= 0 && origin.allFinite(),
          "height grid: spacing and smoothness must be positive, padding and bridge not negative");
}
HeightGrid::HeightGrid(HeightGrid&&) noexcept = default;
HeightGrid& HeightGrid::operator=(HeightGrid&&) noexcept = default;
HeightGrid::~HeightGrid() = default;

size_t HeightGrid::points() const { return sums_->n; }

void HeightGrid::add(std::span<const Vec3> points) {
  Sums& s = *sums_;
  BlockKey last_key;
  BlockSums* last = nullptr;
  for (const Vec3& point : points) {
    const Vec3 p = point - s.origin;
    const double u = p.x() / s.options.spacing_m, v = p.y() / s.options.spacing_m;
    require_data(
        std::abs(u) < double(1 << 28) && std::abs(v) < double(1 << 28) && std::isfinite(p.z()),
        "height grid: a point is not finite or too far from the origin");
    const int i = int(std::floor(u)), j = int(std::floor(v));
    const BlockKey key = block_of(i, j);
    if (!last || key != last_key) {
      last = &s.blocks[key];
      last_key = key;
    }
    const double a = u - i, b = v - j, z = p.z();
    const double w00 = (1 - a) * (1 - b), w10 = a * (1 - b), w01 = (1 - a) * b, w11 = a * b;
    NodeSums* at = last->data() + (j & 31) * kSumSide + (i & 31);
    NodeSums &n00 = at[0], &n10 = at[1], &n01 = at[kSumSide], &n11 = at[kSumSide + 1];
    n00.a[kSelf] += w00 * w00, n10.a[kSelf] += w10 * w10;
    n01.a[kSelf] += w01 * w01, n11.a[kSelf] += w11 * w11;
    n00.a[kEast] += w00 * w10, n01.a[kEast] += w01 * w11;
    n00.a[kNorth] += w00 * w01, n10.a[kNorth] += w10 * w11;
    n00.a[kNorthEast] += w00 * w11, n10.a[kNorthWest] += w10 * w01;
    n00.b += w00 * z, n10.b += w10 * z, n01.b += w01 * z, n11.b += w11 * z;
    s.z += z;
    s.zz += z * z;
    ++s.n;
  }
}

void HeightGrid::merge(const HeightGrid& other) {
  const Sums& o = *other.sums_;
  const HeightGridOptions &a = sums_->options, &b = o.options;
  require(sums_->origin == o.origin && a.spacing_m == b.spacing_m &&
              a.smoothness_m2 == b.smoothness_m2 && a.padding_m == b.padding_m &&
              a.bridge_m == b.bridge_m,
          "height grid: only grids of the same origin and options merge");
  for (const auto& [key, theirs] : o.blocks) {
    BlockSums& mine = sums_->blocks[key];
    for (size_t k = 0; k < theirs.size(); ++k) mine[k] += theirs[k];
  }
  sums_->n += o.n;
  sums_->z += o.z;
  sums_->zz += o.zz;
}

/// Returns the nodes that exist: those near points, and those in gaps that a closing by half of
/// `bridge_m` fills.
NodeMask HeightGrid::Sums::nodes() const {
  NodeMask data;
  for (const auto& [key, block] : blocks) {
    for (int y = 0; y < kSumSide; ++y) {
      for (int x = 0; x < kSumSide; ++x) {
        if (block[size_t(y * kSumSide + x)].a[kSelf] == 0) continue;
        const int i = key.x * kBlockSide + x, j = key.y * kBlockSide + y;
        data[block_of(i, j)][size_t(place_in_block(i, j))] = 1;
      }
    }
  }
  const double half = 0.5 * options.bridge_m / options.spacing_m;
  return united(dilated(data, options.padding_m / options.spacing_m),
                eroded(dilated(data, half), half));
}

namespace {

/// Numbers the nodes row by row through the whole map, so that all couplings lead to later nodes.
BlockMap<int32_t> numbered(const NodeMask& nodes, int32_t& count) {
  BlockMap<int32_t> number;
  for (const auto& [key, block] : nodes) number[key].fill(-1);
  count = 0;
  for (auto row = nodes.begin(); row != nodes.end();) {
    auto end = row;
    while (end != nodes.end() && end->first.y == row->first.y) ++end;
    for (size_t y = 0; y < kBlockSide; ++y) {
      for (auto block = row; block != end; ++block) {
        auto& numbers = number[block->first];
        for (size_t k = y * kBlockSide; k < (y + 1) * kBlockSide; ++k) {
          if (block->second[k]) numbers[k] = count++;
        }
      }
    }
    row = end;
  }
  return number;
}

/// Adds weight · (Σ k_m h_m)² over nodes in row-by-row order, unless one of them does not exist.
template <size_t M>
void add_square(Coefficients& a, const std::array<int32_t, M>& nodes,
                const std::array<std::array<int, 2>, M>& offsets, const std::array<double, M>& k,
                double weight) {
  for (int32_t n : nodes) {
    if (n < 0) return;
  }
  for (size_t m = 0; m < M; ++m) {
    for (size_t l = m; l < M; ++l) {
      const int c = coupling_of(offsets[l][0] - offsets[m][0], offsets[l][1] - offsets[m][1]);
      a[size_t(nodes[m])][size_t(c)] += weight * k[m] * k[l];
    }
  }
}

/// Adds the bending energy, and a trace of membrane energy that settles what the points leave open
/// (the tilt about a single line of points).
void add_bending(Coefficients& a, const BlockMap<int32_t>& number, double weight) {
  constexpr int kSide = kBlockSide + 4;
  constexpr double kMembrane = 1e-8;
  for (const auto& [key, block] : number) {
    const std::vector<int32_t> n = window<int32_t>(number, key, 2, -1);
    for (int y = 2; y < kSide - 2; ++y) {
      for (int x = 2; x < kSide - 2; ++x) {
        const int32_t* at = n.data() + ptrdiff_t(y) * kSide + x;
        if (at[0] < 0) continue;
        const int32_t e = at[1], ee = at[2], u = at[kSide], uu = at[2 * kSide], ue = at[kSide + 1];
        add_square<3>(a, {at[0], e, ee}, {{{0, 0}, {1, 0}, {2, 0}}}, {1, -2, 1}, weight);
        add_square<3>(a, {at[0], u, uu}, {{{0, 0}, {0, 1}, {0, 2}}}, {1, -2, 1}, weight);
        add_square<4>(a, {at[0], e, u, ue}, {{{0, 0}, {1, 0}, {0, 1}, {1, 1}}}, {1, -1, -1, 1},
                      2 * weight);
        add_square<2>(a, {at[0], e}, {{{0, 0}, {1, 0}}}, {1, -1}, kMembrane * weight);
        add_square<2>(a, {at[0], u}, {{{0, 0}, {0, 1}}}, {1, -1}, kMembrane * weight);
      }
    }
  }
}

/// Returns the lower triangle of the matrix. `number` leads from a node to the nodes that it is
/// coupled with.
Matrix matrix_of(const Coefficients& a, const BlockMap<int32_t>& number) {
  constexpr int kSide = kBlockSide + 4;
  constexpr int kAscending[kCouplings] = {kSelf,  kEast,      kEast2, kNorthWest,
                                          kNorth, kNorthEast, kNorth2};
  std::vector<std::array<int32_t, kCouplings>> rows(a.size());
  for (const auto& [key, block] : number) {
    const std::vector<int32_t> n = window<int32_t>(number, key, 2, -1);
    for (int y = 2; y < kSide - 2; ++y) {
      for (int x = 2; x < kSide - 2; ++x) {
        const int32_t* at = n.data() + ptrdiff_t(y) * kSide + x;
        if (at[0] < 0) continue;
        for (int c = 0; c < kCouplings; ++c) {
          rows[size_t(at[0])][size_t(c)] = at[kStep[c][1] * kSide + kStep[c][0]];
        }
      }
    }
  }
  Matrix m(Eigen::Index(a.size()), Eigen::Index(a.size()));
  m.reserve(Eigen::Index(a.size() * kCouplings));
  for (size_t column = 0; column < a.size(); ++column) {
    m.startVec(Eigen::Index(column));
    for (int c : kAscending) {
      const int32_t row = rows[column][size_t(c)];
      if (row >= 0) m.insertBack(row, Eigen::Index(column)) = a[column][size_t(c)];
    }
  }
  m.finalize();
  return m;
}

}  // namespace

HeightMap HeightGrid::solve() const {
  const Sums& s = *sums_;
  HeightMap map{s.origin, s.options.spacing_m, 0, s.n, {}, {}};
  if (s.n == 0) return map;
  map.exists = s.nodes();
  int32_t count = 0;
  const BlockMap<int32_t> number = numbered(map.exists, count);
  Coefficients a(size_t(count), {0, 0, 0, 0, 0, 0, 0});
  Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
  for (const auto& [key, block] : s.blocks) {
    const std::vector<int32_t> n = window<int32_t>(number, key, 1, -1);
    for (int y = 0; y < kSumSide; ++y) {
      for (int x = 0; x < kSumSide; ++x) {
        const NodeSums& from = block[size_t(y * kSumSide + x)];
        if (from.a[kSelf] == 0) continue;
        const int32_t to = n[size_t((y + 1) * (kBlockSide + 2) + x + 1)];
        for (size_t c = 0; c < 5; ++c) a[size_t(to)][c] += from.a[c];
        b[to] += from.b;
      }
    }
  }
  // Heights count from their mean, so that the sum of squares loses fewer digits.
  const Matrix data = matrix_of(a, number);
  const double mean = s.z / double(s.n);
  const Eigen::VectorXd weights =
      data.selfadjointView<Eigen::Lower>() * Eigen::VectorXd::Ones(count);
  b -= mean * weights;
  add_bending(a, number, s.options.smoothness_m2 / (s.options.spacing_m * s.options.spacing_m));
  const Matrix all = matrix_of(a, number);

  Eigen::ConjugateGradient<
      Matrix, Eigen::Lower,
      Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>>>
      solver;
  solver.setTolerance(1e-10);
  solver.setMaxIterations(20000);
  solver.compute(all);
  const Eigen::VectorXd h = solver.solve(b);
  const Eigen::VectorXd data_h = data.selfadjointView<Eigen::Lower>() * h;
  const double misfit =
      s.zz - 2 * mean * s.z + double(s.n) * mean * mean - 2 * h.dot(b) + h.dot(data_h);
  map.sigma_m = std::sqrt(std::max(0.0, misfit) / double(s.n));
  for (const auto& [key, numbers] : number) {
    auto& heights = map.height[key];
    for (size_t k = 0; k < kBlockNodes; ++k) {
      heights[k] = numbers[k] < 0 ? 0 : mean + h[numbers[k]];
    }
  }
  return map;
}

}  // namespace underbrush::ground
