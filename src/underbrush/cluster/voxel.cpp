#include "underbrush/cluster/voxel.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::cluster {
namespace {

/// Numbers codes in order of arrival. It is a hash table with open addressing that grows at half
/// load.
class CodeTable {
 public:
  CodeTable() : slots_(1024, kEmpty) {}

  uint32_t number(uint64_t code) {
    size_t at = mix64(code) & (slots_.size() - 1);
    for (; slots_[at] != kEmpty; at = (at + 1) & (slots_.size() - 1)) {
      if (codes_[slots_[at]] == code) return slots_[at];
    }
    const uint32_t number = slots_[at] = uint32_t(codes_.size());
    codes_.push_back(code);
    if (2 * codes_.size() > slots_.size()) grow();
    return number;
  }
  const std::vector<uint64_t>& codes() const { return codes_; }

 private:
  static constexpr uint32_t kEmpty = 0xffffffffu;

  void grow() {
    slots_.assign(2 * slots_.size(), kEmpty);
    for (uint32_t n = 0; n < codes_.size(); ++n) {
      size_t at = mix64(codes_[n]) & (slots_.size() - 1);
      while (slots_[at] != kEmpty) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = n;
    }
  }

  std::vector<uint32_t> slots_;
  std::vector<uint64_t> codes_;
};

}  // namespace

Voxels occupied_voxels(std::span<const Vec3f> points, double side_m) {
  require(side_m > 0, "the side of a voxel must be positive");
  Voxels out;
  out.clusters.group.resize(points.size());
  if (points.empty()) return out;
  Vec3f low = points[0], high = points[0];
  for (const Vec3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // One empty layer all around keeps the codes of an occupied cube's neighbours within the box.
  const Eigen::Array3d base = (low.cast<double>().array() / side_m).floor() - 1;
  require_data(((high.cast<double>().array() / side_m).floor() - base).maxCoeff() < 2e6,
               "the points span too many voxels: make them larger");
  CodeTable table;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array3d cube = (points[i].cast<double>().array() / side_m).floor() - base;
    out.clusters.group[i] =
        table.number(uint64_t(voxel_step(int(cube.x()), int(cube.y()), int(cube.z()))));
  }
  const std::vector<uint64_t>& codes = table.codes();
  std::vector<uint32_t> order(codes.size()), rank(codes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return codes[a] < codes[b]; });
  out.code.reserve(codes.size());
  for (uint32_t r = 0; r < order.size(); ++r) {
    rank[order[r]] = r;
    out.code.push_back(codes[order[r]]);
  }
  for (uint32_t& g : out.clusters.group) g = rank[g];
  out.clusters.count = uint32_t(codes.size());
  return out;
}

Clusters voxel_clusters(std::span<const Vec3f> points, const VoxelOptions& options) {
  Clusters clusters = occupied_voxels(points, options.side_m).clusters;
  drop_small(clusters, options.min_points);
  return clusters;
}

}  // namespace underbrush::cluster
