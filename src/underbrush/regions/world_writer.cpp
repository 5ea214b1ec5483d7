#include "underbrush/regions/world_writer.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/element_light.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/regions/files.hpp"

namespace underbrush::regions {
namespace fs = std::filesystem;
namespace {

constexpr double kMarginM = 0.01;  // m; more than coordinates are rounded by

Eigen::AlignedBox3d box_of(const elements::Instance& placed, const Eigen::AlignedBox3d& model) {
  Eigen::AlignedBox3d box;
  for (int k = 0; !model.isEmpty() && k < 8; ++k) {
    const Vec3 corner = model.corner(Eigen::AlignedBox3d::CornerType(k));
    box.extend(placed.world_from_model * Vec3(double(placed.scale) * corner));
  }
  return box;
}

void add_numbers(io::PlyData& data, const char* name, std::vector<uint32_t> numbers) {
  io::PlyElement e;
  e.name = name;
  e.count = numbers.size();
  e.columns.emplace_back(kNumberColumn, std::move(numbers));
  data.elements.push_back(std::move(e));
}

/// Returns the world as it is without elements, but with what stands for all regions.
elements::Model common_of(const elements::Model& whole) {
  elements::Model common = whole.like();
  common.keyframes = whole.keyframes;
  common.observed = whole.observed;
  if (whole.observed) common.ground = whole.ground;
  return common;
}

}  // namespace

void check_world_output(const fs::path& path) {
  io::check_output_folder(path, is_world(path), "not a world of regions");
}

WorldWriter::WorldWriter(const fs::path& path, double side_m)
    : folder_((check_world_output(path), path), io::OutputKind::kFolder) {
  require(std::isfinite(side_m) && side_m > 0, "regions: the side must be positive");
  index_.side_m = side_m;
  make_temporary_folders(folder_.temporary());
}

void WorldWriter::add(const Cell2& square, RegionContent content,
                      std::span<const Eigen::AlignedBox3d> boxes) {
  Region region;
  region.square = square;
  const Eigen::AlignedBox3d own = content.model.box();
  if (!own.isEmpty()) {
    region.bounds.extend(content.model.origin + own.min());
    region.bounds.extend(content.model.origin + own.max());
  }
  for (const elements::Instance& i : content.instances) {
    region.bounds.extend(box_of(i, boxes[i.model]));
  }
  if (region.bounds.isEmpty()) return;
  region.bounds.min().array() -= kMarginM;
  region.bounds.max().array() += kMarginM;
  region.instances = uint32_t(content.instances.size());
  io::PlyData numbers;
  for (size_t k = 0; k < content.numbers.size(); ++k) {
    region.elements[k] = uint32_t(content.numbers[k].size());
    add_numbers(numbers, kNumberElements[k], std::move(content.numbers[k]));
  }
  add_numbers(numbers, kNumberElements[3], std::move(content.instance_numbers));
  const fs::path folder = folder_.temporary() / folder_of(square);
  make_temporary_folders(folder.parent_path());
  elements::write_model(folder, content.model, [&](const fs::path& in) {
    io::write_ply(in / kNumbersFile, numbers);
    elements::write_instances(in / kInstancesFile, content.instances, content.labels);
  });
  region.hash = io::hash_of(folder);
  index_.regions.push_back(std::move(region));
}

void WorldWriter::finish(const elements::Model& whole, const std::string& provenance) {
  elements::Model common = common_of(whole);
  common.provenance = provenance;
  elements::write_model(folder_.temporary() / kCommonFolder, common);
  index_.provenance = provenance;
  for (size_t k = 0; k < index_.reflectance.size(); ++k) {
    index_.reflectance[k] = elements::mean_reflectance(whole, elements::Kind(k));
  }
  commit();
}

void WorldWriter::finish(const elements::Scene& common, const elements::SceneInfo& info) {
  index_.is_scene = true;
  index_.common_instances = common.numbers;
  index_.provenance = info.provenance;
  const elements::Model& first = common.models.at(0);
  for (size_t k = 0; k < index_.reflectance.size(); ++k) {
    index_.reflectance[k] = elements::mean_reflectance(first, elements::Kind(k));
  }
  elements::write_scene(folder_.temporary() / kCommonFolder, common, info);
  commit();
}

void WorldWriter::commit() {
  std::ranges::sort(index_.regions, [](const Region& a, const Region& b) {
    return std::pair(a.square.y, a.square.x) < std::pair(b.square.y, b.square.x);
  });
  write_index(folder_.temporary(), index_);
  folder_.commit();
}

}  // namespace underbrush::regions
