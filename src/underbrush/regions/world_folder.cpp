#include "underbrush/regions/world_folder.hpp"

#include <algorithm>
#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/regions/files.hpp"

namespace underbrush::regions {
namespace fs = std::filesystem;
namespace {

/// Returns the order in which numbers ascend. Throws `FormatError` where two are the same.
std::vector<uint32_t> ascending(const fs::path& file, const std::vector<uint32_t>& numbers) {
  std::vector<uint32_t> order(numbers.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](uint32_t k) { return numbers[k]; });
  for (size_t k = 1; k < order.size(); ++k) {
    if (numbers[order[k]] != numbers[order[k - 1]]) continue;
    throw FormatError(file.string(), "", "two regions have the same element or instance");
  }
  return order;
}

template <class T>
void reorder(const std::vector<uint32_t>& order, std::vector<T>& values) {
  if (values.empty()) return;
  std::vector<T> out(order.size());
  for (size_t k = 0; k < order.size(); ++k) out[k] = std::move(values[order[k]]);
  values = std::move(out);
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(elements::TriangleMesh& to, const elements::TriangleMesh& from) {
  const auto first = uint32_t(to.vertices.size());
  append(to.vertices, from.vertices);
  for (const auto& [a, b, c] : from.triangles) {
    to.triangles.push_back({first + a, first + b, first + c});
  }
  append(to.hit, from.hit);
  append(to.light, from.light);
  append(to.roughness, from.roughness);
}

void reorder(const std::vector<uint32_t>& order, elements::TriangleMesh& mesh) {
  reorder(order, mesh.triangles);
  reorder(order, mesh.hit);
  reorder(order, mesh.light);
  reorder(order, mesh.roughness);
}

/// Puts parts of a world together.
class Assembly {
 public:
  Assembly(WorldPart common, const Index& index, std::vector<uint32_t> common_instances)
      : index_(index), out_(std::move(common)), instances_(std::move(common_instances)) {}

  void add(const fs::path& folder, const Region& region) {
    const elements::Model read = elements::read_model(folder);
    append(model().ground, read.ground);
    append(model().surface, read.surface);
    append(model().ellipsoids, read.ellipsoids);
    elements::read_instances(folder / kInstancesFile, out_.scene, out_.info);
    const fs::path file = folder / kNumbersFile;
    const io::PlyData data = io::read_ply(file);
    for (size_t k = 0; k < std::size(kNumberElements); ++k) {
      const auto& numbers = io::column_of<uint32_t>(
          file, io::element_of(file, data, kNumberElements[k]), kNumberColumn);
      if (numbers.size() != (k < 3 ? region.elements[k] : region.instances)) {
        throw FormatError(file.string(), kNumberElements[k], "the index has another count");
      }
      append(k < 3 ? numbers_[k] : instances_, numbers);
    }
    if (read.ground.size() != region.elements[0] || read.surface.size() != region.elements[1] ||
        read.ellipsoids.size() != region.elements[2]) {
      throw FormatError(folder.string(), "", "the index has another number of elements");
    }
  }

  WorldPart finish(const fs::path& path, std::shared_ptr<const elements::TriangleMesh> ground) && {
    auto part = std::make_shared<elements::PartOf>();
    part->counts = index_.elements();
    part->reflectance = index_.reflectance;
    part->ground = std::move(ground);
    for (size_t k = 0; k < numbers_.size(); ++k) {
      const std::vector<uint32_t> order = ascending(path, numbers_[k]);
      if (k == 0) reorder(order, model().ground);
      if (k == 1) reorder(order, model().surface);
      if (k == 2) reorder(order, model().ellipsoids);
      reorder(order, numbers_[k]);
    }
    part->numbers = std::move(numbers_);
    model().part_of = std::move(part);
    if (index_.is_scene) sort_instances(path);
    try {
      out_.scene.check();
    } catch (const std::invalid_argument& e) {
      throw FormatError(path.string(), "", e.what());
    }
    return std::move(out_);
  }

 private:
  elements::Model& model() { return out_.scene.models[0]; }

  void sort_instances(const fs::path& path) {
    if (instances_.size() != out_.scene.instances.size()) {
      throw FormatError(path.string(), "", "instances and their numbers differ");
    }
    const std::vector<uint32_t> order = ascending(path, instances_);
    if (!order.empty() && instances_[order.back()] >= index_.instances()) {
      throw FormatError(path.string(), "",
                        "an instance's number is beyond the number of instances");
    }
    std::vector<uint32_t> place(order.size());
    for (size_t k = 0; k < order.size(); ++k) place[order[k]] = uint32_t(k);
    for (elements::Mover& m : out_.info.movers) m.instance = place[m.instance];
    reorder(order, out_.scene.instances);
    reorder(order, out_.info.labels);
    reorder(order, instances_);
    out_.scene.numbers = std::move(instances_);
  }

  const Index& index_;
  WorldPart out_;
  std::array<std::vector<uint32_t>, 3> numbers_;
  std::vector<uint32_t> instances_;
};

}  // namespace

std::vector<fs::path> hashed_parts(const fs::path& path) {
  if (!is_world(path)) return {path};
  return {path / kIndexFile, path / kCommonFolder};
}

WorldFolder::WorldFolder(fs::path path)
    : path_(std::move(path)),
      index_(read_index(path_)),
      checked_(new std::atomic<bool>[index_.regions.size()]()) {
  const fs::path folder = path_ / kCommonFolder;
  if (index_.is_scene) {
    common_.scene = elements::read_scene(folder, &common_.info);
    if (common_.scene.instances.empty() ||
        common_.scene.instances.size() != index_.common_instances.size()) {
      throw FormatError(folder.string(), "", "the index has another number of instances");
    }
    return;
  }
  common_.scene.models.push_back(elements::read_model(folder));
  elements::Model& model = common_.scene.models[0];
  common_.info.class_names = model.class_names;
  if (!model.observed) return;
  auto ground = std::make_shared<elements::TriangleMesh>();
  ground->vertices = std::move(model.ground.vertices);
  ground_ = std::move(ground);
  model.ground = model.like().ground;
}

uint64_t WorldFolder::common_bytes() const {
  Region common;
  for (const elements::Model& m : common_.scene.models) {
    common.elements[0] += uint32_t(m.triangle_count());
    common.elements[2] += uint32_t(m.ellipsoids.size());
  }
  return common.bytes();
}

WorldPart WorldFolder::part(std::span<const uint32_t> regions) const {
  Assembly assembly(common_, index_, index_.common_instances);
  for (const uint32_t k : regions) {
    const Region& region = index_.regions.at(k);
    const fs::path folder = path_ / folder_of(region.square);
    if (!checked_[k] && io::hash_of(folder) != region.hash) {
      throw FormatError(folder.string(), "", "its hash differs from that in the index");
    }
    checked_[k] = true;
    assembly.add(folder, region);
  }
  return std::move(assembly).finish(path_, ground_);
}

WorldPart WorldFolder::whole() const {
  std::vector<uint32_t> all(index_.regions.size());
  std::iota(all.begin(), all.end(), 0);
  WorldPart out = part(all);
  out.scene.models[0].part_of = nullptr;
  out.scene.numbers.clear();
  return out;
}

}  // namespace underbrush::regions
