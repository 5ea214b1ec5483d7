#include "underbrush/ground/height_sums.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::ground {
namespace {

/// The coarse nodes along one axis whose mean is a fine node: two, which are equal at even places.
struct Parents {
  int at[2];
  explicit Parents(int i) : at{i >> 1, (i + 1) >> 1} {}
};

/// A coarse node's share of a fine node.
struct Share {
  int i, j;
  double weight;
};

/// Returns the four shares of fine node (i, j), of which some may be of the same node.
std::array<Share, 4> shares(int i, int j) {
  const Parents x(i), y(j);
  return {{{x.at[0], y.at[0], 0.25},
           {x.at[1], y.at[0], 0.25},
           {x.at[0], y.at[1], 0.25},
           {x.at[1], y.at[1], 0.25}}};
}

/// The sums of a coarse block, whose first node is (i0, j0).
struct CoarseBlock {
  BlockSums& sums;
  int i0, j0;

  NodeSums& at(int i, int j) const { return sums[place_in_sums(i - i0, j - j0)]; }

  /// Adds `value` to the matrix at row p and column q and, where these differ, at row q and column
  /// p, if q does not precede p.
  void add(const Share& p, const Share& q, double value) const {
    const int dx = q.i - p.i, dy = q.j - p.j;
    if (dy < 0 || (dy == 0 && dx < 0)) return;
    at(p.i, p.j).a[coupling_of(dx, dy)] += value * p.weight * q.weight;
  }

  /// Adds the sums of fine node (i, j).
  void add(int i, int j, const NodeSums& fine) const {
    const auto from = shares(i, j);
    for (const Share& p : from) {
      at(p.i, p.j).b += p.weight * fine.b;
      for (const Share& q : from) add(p, q, fine.a[kSelf]);
    }
    for (int c = 1; c < kPointCouplings; ++c) {
      if (fine.a[c] == 0) continue;
      for (const Share& p : from) {
        for (const Share& q : shares(i + kStep[c][0], j + kStep[c][1])) {
          add(p, q, fine.a[c]);
          add(q, p, fine.a[c]);
        }
      }
    }
  }
};

}  // namespace

void HeightSums::add(std::span<const Vec3> points) {
  BlockKey last_key;
  BlockSums* last = nullptr;
  for (const Vec3& point : points) {
    const Vec3 p = point - origin;
    const double u = p.x() / options.spacing_m, v = p.y() / options.spacing_m;
    require_data(
        std::abs(u) < double(1 << 28) && std::abs(v) < double(1 << 28) && std::isfinite(p.z()),
        "height grid: a point is not finite or too far from the origin");
    const int i = int(std::floor(u)), j = int(std::floor(v));
    const BlockKey key = block_of(i, j);
    if (!last || key != last_key) {
      last = &blocks[key];
      last_key = key;
    }
    const double a = u - i, b = v - j, h = p.z();
    const double w00 = (1 - a) * (1 - b), w10 = a * (1 - b), w01 = (1 - a) * b, w11 = a * b;
    NodeSums* at = last->data() + place_in_sums(i & 31, j & 31);
    NodeSums &n00 = at[0], &n10 = at[1], &n01 = at[kSumSide], &n11 = at[kSumSide + 1];
    n00.a[kSelf] += w00 * w00, n10.a[kSelf] += w10 * w10;
    n01.a[kSelf] += w01 * w01, n11.a[kSelf] += w11 * w11;
    n00.a[kEast] += w00 * w10, n01.a[kEast] += w01 * w11;
    n00.a[kNorth] += w00 * w01, n10.a[kNorth] += w10 * w11;
    n00.a[kNorthEast] += w00 * w11, n10.a[kNorthWest] += w10 * w01;
    n00.b += w00 * h, n10.b += w10 * h, n01.b += w01 * h, n11.b += w11 * h;
    z += h;
    zz += h * h;
    ++n;
  }
}

void HeightSums::merge(const HeightSums& other) {
  for (const auto& [key, theirs] : other.blocks) {
    BlockSums& mine = blocks[key];
    for (size_t k = 0; k < theirs.size(); ++k) mine[k] += theirs[k];
  }
  n += other.n;
  z += other.z;
  zz += other.zz;
}

size_t HeightSums::cells() const {
  size_t count = 0;
  for (const auto& [key, block] : blocks) {
    for (const NodeSums& node : block) count += node.a[kNorthEast] > 0;
  }
  return count;
}

HeightSums HeightSums::coarsened() const {
  HeightSums out{origin, options, {}, n, z, zz};
  out.options.spacing_m *= 2;
  for (const auto& [key, block] : blocks) {
    // All nodes of a block, those beyond it included, lie within one coarse block and its border.
    const BlockKey to{key.y >> 1, key.x >> 1};
    const CoarseBlock coarse{out.blocks[to], to.x * kBlockSide, to.y * kBlockSide};
    for (int y = 0; y < kSumSide; ++y) {
      for (int x = 0; x < kSumSide; ++x) {
        const NodeSums& fine = block[place_in_sums(x, y)];
        if (fine.a[kSelf] > 0) coarse.add(key.x * kBlockSide + x, key.y * kBlockSide + y, fine);
      }
    }
  }
  return out;
}

NodeMask HeightSums::nodes() const {
  NodeMask data;
  for (const auto& [key, block] : blocks) {
    for (int y = 0; y < kSumSide; ++y) {
      for (int x = 0; x < kSumSide; ++x) {
        if (block[place_in_sums(x, y)].a[kSelf] == 0) continue;
        const int i = key.x * kBlockSide + x, j = key.y * kBlockSide + y;
        data[block_of(i, j)][size_t(place_in_block(i, j))] = 1;
      }
    }
  }
  const double half = 0.5 * options.bridge_m / options.spacing_m;
  return united(dilated(data, options.padding_m / options.spacing_m),
                eroded(dilated(data, half), half));
}

}  // namespace underbrush::ground
