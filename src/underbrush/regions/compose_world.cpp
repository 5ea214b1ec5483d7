#include "underbrush/regions/compose_world.hpp"

#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/regions/world_writer.hpp"

namespace underbrush::regions {
namespace {

std::vector<uint32_t> numbers_from(uint32_t first, size_t count) {
  std::vector<uint32_t> out(count);
  std::iota(out.begin(), out.end(), first);
  return out;
}

/// Takes the instances of a composition for a region, all but the first.
void take_instances(primitives::Composition& c, uint32_t first_number, RegionContent& to) {
  require_data(c.info.movers.empty(), "compose: objects of a site in parts must not move");
  to.instances.assign(c.scene.instances.begin() + 1, c.scene.instances.end());
  to.labels.assign(c.info.labels.begin() + 1, c.info.labels.end());
  to.instance_numbers = numbers_from(first_number, to.instances.size());
  c.scene.instances.resize(1);
  c.info.labels.resize(1);
  c.object_of.clear();
}

}  // namespace

primitives::Composition compose_world(
    const std::filesystem::path& path, const SiteFolder& site, const primitives::PrimitiveSet& set,
    const primitives::ComposeOptions& options, bool outside, const std::string& provenance,
    const std::function<void(const primitives::Composition&)>& accept,
    const PartProgress& progress) {
  for (const auto& [label, density] : options.density) {
    require(density <= 1, "compose: a class density above 1 is not for a site in parts");
  }
  require_data(!site.parts.empty(), "compose: the site has no parts");
  WorldWriter writer(path, site.side_m);
  std::unique_ptr<primitives::Composer> composer;
  std::vector<Eigen::AlignedBox3d> boxes;
  uint32_t triangles = 0, instances = 1;
  size_t done = 0;
  for (const SitePart& part : site.parts) {
    const primitives::Annotation annotation = primitives::read_annotation(part.annotation, outside);
    const elements::Model ground = elements::read_model(annotation.ground);
    if (!composer) composer = std::make_unique<primitives::Composer>(ground, set, options);
    if (part.place.x == 0) composer->forget_below(part.south_m);
    composer->add(primitives::GroundSurface(ground), annotation.objects);
    primitives::Composition& composed = composer->result();
    while (boxes.size() < composed.scene.models.size()) {
      boxes.push_back(composed.scene.models[boxes.size()].box());
    }
    require_data(ground.origin == composed.scene.instances[0].world_from_model.translation,
                 "compose: the grounds of the parts have different origins");
    RegionContent content;
    content.model = ground.like();
    content.model.ground = ground.ground;
    content.numbers[0] = numbers_from(triangles, ground.ground.size());
    take_instances(composed, instances, content);
    triangles += uint32_t(ground.ground.size());
    instances += uint32_t(content.instances.size());
    writer.add(part.place, std::move(content), boxes);
    if (progress) progress(++done, site.parts.size());
  }
  primitives::Composition out = std::move(composer->result());
  out.info.provenance = provenance;
  if (accept) accept(out);
  out.scene.numbers = {0};
  writer.finish(out.scene, out.info);
  return out;
}

}  // namespace underbrush::regions
