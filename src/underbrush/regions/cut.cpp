#include "underbrush/regions/cut.hpp"

#include <map>
#include <set>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/regions/world_writer.hpp"

namespace underbrush::regions {
namespace {

/// The places of what stands in a region, in the arrays of the whole.
struct Places {
  std::array<std::vector<uint32_t>, 3> elements;  // by elements::Kind
  std::vector<uint32_t> instances;
};
using PlacesOfSquare = std::map<Cell2, Places>;

Vec3 middle_of(const elements::Model& model, const elements::ElementPlace& at) {
  if (at.kind == elements::Kind::kEllipsoid) {
    return model.ellipsoids[at.index].mean.cast<double>();
  }
  const elements::TriangleMesh& mesh = model.mesh(at.kind);
  Vec3 sum = Vec3::Zero();
  for (const uint32_t v : mesh.triangles[at.index]) sum += mesh.vertices[v].cast<double>();
  return sum / 3;
}

template <class T>
std::vector<T> taken(const std::vector<T>& from, const std::vector<uint32_t>& places) {
  std::vector<T> out;
  if (from.empty()) return out;
  out.reserve(places.size());
  for (const uint32_t k : places) out.push_back(from[k]);
  return out;
}

elements::TriangleMesh taken(const elements::TriangleMesh& from,
                             const std::vector<uint32_t>& places) {
  elements::TriangleMesh mesh;
  mesh.range_sigma_m = from.range_sigma_m;
  mesh.roughness_m = from.roughness_m;
  mesh.hit = taken(from.hit, places);
  mesh.light = taken(from.light, places);
  mesh.roughness = taken(from.roughness, places);
  std::unordered_map<uint32_t, uint32_t> vertex;
  for (const uint32_t k : places) {
    std::array<uint32_t, 3> corners = from.triangles[k];
    for (uint32_t& v : corners) {
      const auto [at, is_new] = vertex.try_emplace(v, uint32_t(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(from.vertices[v]);
      v = at->second;
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

void check_cut(const elements::Scene& scene, const elements::SceneInfo& info) {
  const elements::Instance& first = scene.instances[0];
  const bool plain = first.scale == 1 && first.world_from_model.rotation.coeffs() ==
                                             Eigen::Quaterniond::Identity().coeffs();
  require_data(first.model == 0 && plain,
               "regions: the scene does not begin with its first model, unturned and unscaled");
  for (size_t k = 1; k < scene.instances.size(); ++k) {
    require_data(scene.instances[k].model != first.model,
                 "regions: the first instance of the scene, which is cut, stands twice");
  }
  for (const elements::Mover& m : info.movers) {
    require_data(m.instance != 0, "regions: the first instance of the scene, which is cut, moves");
  }
  require_data(!scene.models[0].observed,
               "regions: the model of the first instance has a map of observed space");
}

/// Returns the scene's common part: its models, the first one without elements, and the first
/// instance and those that move.
elements::Scene common_of(const elements::Scene& scene, elements::SceneInfo& info) {
  std::set<uint32_t> kept{0};
  for (const elements::Mover& m : info.movers) kept.insert(m.instance);
  elements::Scene common;
  common.models = scene.models;
  const elements::SceneInfo whole = info;
  info.labels.clear();
  for (const uint32_t k : kept) {
    for (size_t m = 0; m < info.movers.size(); ++m) {
      if (whole.movers[m].instance == k) {
        info.movers[m].instance = uint32_t(common.instances.size());
      }
    }
    common.instances.push_back(scene.instances[k]);
    common.numbers.push_back(k);
    info.labels.push_back(whole.labels[k]);
  }
  return common;
}

/// The origin of the model that is cut.
Vec3 origin_of(const elements::Scene& scene) {
  return scene.instances.empty() ? scene.models.at(0).origin
                                 : scene.instances[0].world_from_model.translation;
}

}  // namespace

double side_by_elements(const elements::Scene& scene) {
  constexpr int kSmallest = 16, kLargest = 1024;
  const elements::Model& model = scene.models.at(0);
  const Vec3 origin = origin_of(scene);
  std::set<Cell2> squares;
  const auto add = [&](const Vec3& at) { squares.insert(cell_of(at.x(), at.y(), kSmallest)); };
  for (size_t k = 0; k < model.size(); ++k) add(origin + middle_of(model, model.place_at(k)));
  for (size_t k = 1; k < scene.instances.size(); ++k) {
    add(scene.instances[k].world_from_model.translation);
  }
  const size_t all = model.size() + scene.instances.size();
  int side = kLargest;
  for (; side > kSmallest; side /= 2) {
    std::set<Cell2> regions;
    for (const Cell2& c : squares) {
      regions.insert(cell_of((c.x + 0.5) * kSmallest, (c.y + 0.5) * kSmallest, side));
    }
    if (all <= kMostOfRegion * regions.size()) break;
  }
  return side;
}

size_t write_world(const std::filesystem::path& path, const elements::Scene& scene,
                   const elements::SceneInfo& info, double side_m, const std::string& provenance) {
  const bool is_scene = !scene.instances.empty();
  if (is_scene) check_cut(scene, info);
  const elements::Model& model = scene.models.at(0);
  const Vec3 origin = origin_of(scene);
  WorldWriter writer(path, side_m);
  PlacesOfSquare squares;
  for (size_t k = 0; k < model.size(); ++k) {
    const elements::ElementPlace at = model.place_at(k);
    const Vec3 middle = origin + middle_of(model, at);
    squares[cell_of(middle.x(), middle.y(), side_m)].elements[size_t(at.kind)].push_back(at.index);
  }
  std::set<uint32_t> moving;
  for (const elements::Mover& m : info.movers) moving.insert(m.instance);
  for (uint32_t k = 1; k < scene.instances.size(); ++k) {
    if (moving.contains(k)) continue;
    const Vec3& at = scene.instances[k].world_from_model.translation;
    squares[cell_of(at.x(), at.y(), side_m)].instances.push_back(k);
  }
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const elements::Model& m : scene.models) boxes.push_back(m.box());
  for (auto& [square, places] : squares) {
    RegionContent content;
    content.model = model.like();
    content.model.origin = origin;
    content.model.ground = taken(model.ground, places.elements[0]);
    content.model.surface = taken(model.surface, places.elements[1]);
    content.model.ellipsoids = taken(model.ellipsoids, places.elements[2]);
    content.numbers = std::move(places.elements);
    content.instances = taken(scene.instances, places.instances);
    content.labels = taken(info.labels, places.instances);
    content.instance_numbers = std::move(places.instances);
    writer.add(square, std::move(content), boxes);
  }
  if (!is_scene) {
    writer.finish(model, provenance);
    return squares.size();
  }
  elements::SceneInfo kept = info;
  kept.provenance = provenance;
  elements::Scene common = common_of(scene, kept);
  common.models[0] = model.like();
  writer.finish(common, kept);
  return squares.size();
}

}  // namespace underbrush::regions
