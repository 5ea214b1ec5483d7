#include "underbrush/ground/sparse_sums.hpp"

namespace underbrush::ground {

SparseSums sparse(const HeightSums& sums) {
  SparseSums out{sums.n, sums.z, sums.zz, {}};
  for (const auto& [key, block] : sums.blocks) {
    for (size_t k = 0; k < block.size(); ++k) {
      // A point on a node's far side adds nothing but zeros, which may be left out.
      if (block[k].a[kSelf] > 0) out.nodes.push_back({key, uint16_t(k), block[k]});
    }
  }
  return out;
}

void merge(const SparseSums& from, HeightSums& to) {
  for (const SparseSums::Node& node : from.nodes) to.blocks[node.block][node.place] += node.sums;
  to.n += from.n;
  to.z += from.z;
  to.zz += from.zz;
}

}  // namespace underbrush::ground
