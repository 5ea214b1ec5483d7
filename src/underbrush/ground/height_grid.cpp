#include "underbrush/ground/height_grid.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <cmath>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/ground/height_sums.hpp"
#include "underbrush/ground/sparse_sums.hpp"

namespace underbrush::ground {
namespace {

using Matrix = Eigen::SparseMatrix<double>;  // lower triangle
using Coefficients = std::vector<std::array<double, kCouplings>>;

/// Returns whether points are so sparse that most are alone in their cell, and nodes may be twice
/// as far apart.
bool is_sparse(const HeightSums& sums) {
  constexpr double kPointsPerCell = 1.5;
  return 2 * sums.options.spacing_m <= sums.options.coarsest_m &&
         double(sums.n) < kPointsPerCell * double(sums.cells());
}

}  // namespace

HeightGrid::HeightGrid(const Vec3& origin, const HeightGridOptions& options)
    : sums_(new HeightSums{origin, options, {}, 0, 0, 0}) {
  require(options.spacing_m > 0 && options.smoothness_m2 > 0 && options.padding_m >= 0 &&
              options.bridge_m >= 0 && options.coarsest_m >= 0 && origin.allFinite(),
          "height grid: spacing and smoothness must be positive, other lengths not negative");
}
HeightGrid::HeightGrid(HeightGrid&&) noexcept = default;
HeightGrid& HeightGrid::operator=(HeightGrid&&) noexcept = default;
HeightGrid::~HeightGrid() = default;

size_t HeightGrid::points() const { return sums_->n; }

void HeightGrid::add(std::span<const Vec3> points) { sums_->add(points); }

void HeightGrid::merge(const HeightGrid& other) {
  const HeightGridOptions &a = sums_->options, &b = other.sums_->options;
  require(sums_->origin == other.sums_->origin && a.spacing_m == b.spacing_m &&
              a.smoothness_m2 == b.smoothness_m2 && a.padding_m == b.padding_m &&
              a.bridge_m == b.bridge_m && a.coarsest_m == b.coarsest_m,
          "height grid: only grids of the same origin and options merge");
  sums_->merge(*other.sums_);
}

void HeightGrid::merge(const SparseSums& kept) { ground::merge(kept, *sums_); }

SparseSums HeightGrid::sums() const { return sparse(*sums_); }

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
  HeightSums coarse;
  const HeightSums* at = sums_.get();
  while (is_sparse(*at)) {
    coarse = at->coarsened();
    at = &coarse;
  }
  const HeightSums& s = *at;
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
        const NodeSums& from = block[place_in_sums(x, y)];
        if (from.a[kSelf] == 0) continue;
        const int32_t to = n[size_t(y + 1) * (kBlockSide + 2) + size_t(x + 1)];
        for (size_t c = 0; c < kPointCouplings; ++c) a[size_t(to)][c] += from.a[c];
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
