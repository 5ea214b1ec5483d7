#include "underbrush/rasters/region_blocks.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/regions/open_regions.hpp"

namespace underbrush::rasters {
namespace {

/// A stand that is computed in blocks.
class Blocks {
 public:
  Blocks(const regions::WorldFolder& world, uint64_t memory_bytes, const CanopyOptions& options)
      : world_(world),
        memory_bytes_(memory_bytes),
        for_regions_(memory_bytes - std::min(memory_bytes, world.common_bytes())),
        maker_(bounds(), options) {}

  Canopy canopy() && {
    add(maker_.all());
    return std::move(maker_).finish(world_.part({}).scene.models);
  }

 private:
  /// The box of the world's elements, which is that of all parts.
  metrics::Bounds bounds() const {
    metrics::Bounds all;
    std::vector<uint32_t> open;
    uint64_t bytes = 0;
    const size_t count = world_.index().regions.size();
    for (uint32_t k = 0; k < count; ++k) {
      open.push_back(k);
      bytes += bytes_of(k);
      if (k + 1 < count && bytes + bytes_of(k + 1) <= for_regions_) continue;
      const elements::Scene scene = world_.part(open).scene;
      metrics::add_bounds(scene.models, scene.instances, all);
      open.clear();
      bytes = 0;
    }
    return all;
  }

  uint64_t bytes_of(uint32_t region) const { return world_.index().regions[region].bytes(); }

  /// Adds a block, in parts where its regions and the sums of its voxels do not fit into memory.
  void add(const CellBlock& block) {
    const Eigen::AlignedBox2d square = maker_.box_of(block);
    std::vector<uint32_t> needed;
    uint64_t bytes = sizeof(double) * maker_.voxels(block);
    for (uint32_t k = 0; k < world_.index().regions.size(); ++k) {
      const Eigen::AlignedBox3d& box = world_.index().regions[k].bounds;
      if (!square.intersects({box.min().head<2>(), box.max().head<2>()})) continue;
      needed.push_back(k);
      bytes += bytes_of(k);
    }
    if (bytes > for_regions_) return add_halves(block, bytes);
    const regions::WorldPart part = world_.part(needed);
    maker_.add(pipeline::TracedWorld(part.scene, part.info).still(), block);
  }

  void add_halves(const CellBlock& block, uint64_t bytes) {
    const size_t longer = block.width(1) > block.width(0);
    if (block.width(longer) == 1) {
      regions::throw_too_little_memory("the regions of one column of cells take",
                                       bytes + world_.common_bytes(), memory_bytes_);
    }
    CellBlock first = block, second = block;
    first.end[longer] = second.begin[longer] = block.begin[longer] + block.width(longer) / 2;
    add(first);
    add(second);
  }

  const regions::WorldFolder& world_;
  const uint64_t memory_bytes_, for_regions_;
  CanopyMaker maker_;
};

}  // namespace

Canopy canopy_of_regions(const regions::WorldFolder& world, uint64_t memory_bytes,
                         const CanopyOptions& options) {
  return Blocks(world, memory_bytes, options).canopy();
}

}  // namespace underbrush::rasters
