#include "underbrush/cluster/bottom_up.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "underbrush/cluster/voxel.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::cluster {
namespace {

/// A possible merger of two clusters. It is out of date once one of them has changed.
struct Merger {
  double density;  // density of the merged ellipsoid as a share of that of the two
  uint32_t a, b;   // a < b
  uint32_t version_a, version_b;
  // The greatest density comes first; numbers break ties, so that the order is total.
  bool operator<(const Merger& o) const {
    if (density != o.density) return density < o.density;
    return a != o.a ? a > o.a : b > o.b;
  }
};

/// A cluster while mergers go on.
struct Node {
  PointMoments moments;  // about the tile's first point
  double volume = 0;
  uint32_t version = 0, merged_into;
  std::vector<uint32_t> neighbours;  // ascending, without those merged away
};

class Merging {
 public:
  Merging(std::span<const Vec3f> points, const Voxels& cells, const BottomUpOptions& options)
      : options_(options),
        prior_(options.cell_m * options.cell_m / 12),
        nodes_(cells.clusters.count) {
    const Vec3 about = points[0].cast<double>();
    for (size_t i = 0; i < points.size(); ++i) {
      nodes_[cells.clusters.group[i]].moments.add(points[i].cast<double>() - about);
    }
    for (uint32_t k = 0; k < nodes_.size(); ++k) {
      nodes_[k].volume = volume(nodes_[k].moments);
      nodes_[k].merged_into = k;
    }
    link(cells);
  }

  /// Merges, and gives the cluster of each cell. Clusters are numbered in the order of their first
  /// cells.
  std::vector<uint32_t> run(uint32_t& count) {
    while (!queue_.empty()) {
      const Merger m = queue_.top();
      queue_.pop();
      if (nodes_[m.a].version == m.version_a && nodes_[m.b].version == m.version_b) merge(m);
    }
    std::vector<uint32_t> number(nodes_.size());
    count = 0;
    for (uint32_t k = 0; k < nodes_.size(); ++k) {
      // A cluster keeps the number of its first cell, which comes before its other cells.
      number[k] = nodes_[k].merged_into == k ? count++ : number[root(k)];
    }
    return number;
  }

 private:
  Mat3 covariance(const PointMoments& m) const {
    return (m.scatter() + 3 * prior_ * Mat3::Identity()) / (m.n + 3);
  }
  double volume(const PointMoments& m) const { return std::sqrt(covariance(m).determinant()); }

  uint32_t root(uint32_t k) const {
    while (nodes_[k].merged_into != k) k = nodes_[k].merged_into;
    return k;
  }

  void link(const Voxels& cells) {
    for (uint32_t k = 0; k < nodes_.size(); ++k) {
      for (int step = 0; step < 13; ++step) {  // the 13 of 26 neighbours with a greater code
        const int n = step + 14, di = n / 9 - 1, dj = n / 3 % 3 - 1, dk = n % 3 - 1;
        const uint64_t code = cells.code[k] + uint64_t(voxel_step(di, dj, dk));
        const auto at = std::lower_bound(cells.code.begin() + k, cells.code.end(), code);
        if (at == cells.code.end() || *at != code) continue;
        const uint32_t other = uint32_t(at - cells.code.begin());
        nodes_[k].neighbours.push_back(other);
        nodes_[other].neighbours.push_back(k);
      }
    }
    for (uint32_t k = 0; k < nodes_.size(); ++k) {
      std::sort(nodes_[k].neighbours.begin(), nodes_[k].neighbours.end());
      for (uint32_t other : nodes_[k].neighbours) {
        if (other > k) propose(k, other);
      }
    }
  }

  void propose(uint32_t a, uint32_t b) {
    if (a > b) std::swap(a, b);
    PointMoments both = nodes_[a].moments;
    both.add(nodes_[b].moments);
    if (12 * both.scatter().trace() > both.n * options_.largest_m * options_.largest_m) return;
    const double apart = nodes_[a].volume + nodes_[b].volume;
    const double density = apart / volume(both);
    if (density < options_.least_density) return;
    queue_.push({density, a, b, nodes_[a].version, nodes_[b].version});
  }

  void merge(const Merger& m) {
    Node &a = nodes_[m.a], &b = nodes_[m.b];
    a.moments.add(b.moments);
    a.volume = volume(a.moments);
    ++a.version;
    ++b.version;
    b.merged_into = m.a;
    for (uint32_t other : b.neighbours) {
      std::vector<uint32_t>& theirs = nodes_[other].neighbours;
      theirs.erase(std::lower_bound(theirs.begin(), theirs.end(), m.b));
      if (other == m.a) continue;
      const auto at = std::lower_bound(theirs.begin(), theirs.end(), m.a);
      if (at == theirs.end() || *at != m.a) theirs.insert(at, m.a);
    }
    std::vector<uint32_t> neighbours;
    std::set_union(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(),
                   b.neighbours.end(), std::back_inserter(neighbours));
    std::erase(neighbours, m.a);
    std::erase(neighbours, m.b);
    a.neighbours = std::move(neighbours);
    b.neighbours = {};
    for (uint32_t other : a.neighbours) propose(m.a, other);
  }

  const BottomUpOptions& options_;
  const double prior_;  // variance of a cube's points, m²
  std::vector<Node> nodes_;
  std::priority_queue<Merger> queue_;
};

}  // namespace

Clusters bottom_up_clusters(std::span<const Vec3f> points, const BottomUpOptions& options) {
  require(options.least_density >= 0, "bottom_up: the density must not be negative");
  require(options.largest_m > 0, "bottom_up: the largest extent must be positive");
  Voxels cells = occupied_voxels(points, options.cell_m);
  if (points.empty()) return cells.clusters;
  Clusters& clusters = cells.clusters;
  const std::vector<uint32_t> number = Merging(points, cells, options).run(clusters.count);
  for (uint32_t& g : clusters.group) g = number[g];
  drop_small(clusters, options.min_points);
  return std::move(clusters);
}

}  // namespace underbrush::cluster
