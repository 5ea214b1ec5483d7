#include "underbrush/serve/world_data.hpp"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "underbrush/serve/bytes.inl"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {
namespace {

constexpr uint64_t kMostThumbnail = uint64_t(4) << 20;  // bytes
constexpr double kGap = 1;                              // m, between primitives

// Lays boxes of these sizes in rows from north to south, as wide together as they are deep, with a
// gap around each. Returns the corner of each with the least coordinates.
std::vector<Vec3> shelves_of(const std::vector<Vec3>& sizes) {
  double area = 0;
  for (const Vec3& s : sizes) area += (s.x() + kGap) * (s.y() + kGap);
  const double most = std::sqrt(area);
  std::vector<Vec3> out;
  double y = 0;
  for (size_t first = 0; first < sizes.size();) {
    double x = 0, depth = 0;
    const size_t begin = first;
    for (; first < sizes.size() && (first == begin || x + sizes[first].x() <= most); ++first) {
      out.emplace_back(x, 0, 0);
      x += sizes[first].x() + kGap;
      depth = std::max(depth, sizes[first].y());
    }
    for (size_t k = begin; k < first; ++k) out[k].y() = y - depth;
    y -= depth + kGap;
  }
  return out;
}

}  // namespace

WorldData::WorldData(const OpenedFile& file) : kind_(file.kind), folder_(file.path) {
  if (kind_ == FileKind::kScene) {
    pipeline::World world = pipeline::read_world(file.path);
    scene_ = std::move(world.scene);
    info_ = std::move(world.info);
    if (!scene_.instances.empty()) {
      origin_ = first_poses()[0].translation.array().round();
    }
  } else if (kind_ == FileKind::kModel) {
    scene_.models = pipeline::read_world(file.path).scene.models;
    info_.class_names = scene_.models[0].class_names;
    info_.names.push_back(file.name);
    info_.labels.push_back(elements::Class::kUnknown);
    origin_ = scene_.models[0].origin;
    scene_.instances.emplace_back();
    scene_.instances[0].world_from_model.translation = origin_;
  } else {
    place_primitives(file);
  }
}

void WorldData::place_primitives(const OpenedFile& file) {
  const primitives::PrimitiveSet set = primitives::read_primitive_set(file.path);
  std::vector<Vec3> sizes;
  for (const primitives::PrimitiveEntry& e : set.entries) sizes.push_back(e.box.size());
  const std::vector<Vec3> corners = shelves_of(sizes);
  for (size_t k = 0; k < set.entries.size(); ++k) {
    const Vec3& low = set.entries[k].box.min;
    scene_.models.push_back(primitives::read_primitive(set, k));
    info_.names.push_back(set.entries[k].name);
    info_.labels.push_back(set.entries[k].label);
    boxes_.push_back(set.entries[k].box);
    elements::Instance placed;
    placed.model = uint32_t(k);
    placed.world_from_model.translation = corners[k] - Vec3(low.x(), low.y(), 0);
    scene_.instances.push_back(placed);
  }
}

std::vector<Pose> WorldData::first_poses() const {
  std::vector<Pose> out;
  out.reserve(scene_.instances.size());
  for (const elements::Instance& i : scene_.instances) out.push_back(i.world_from_model);
  for (const elements::Mover& m : info_.movers) {
    out[m.instance] = m.world_from_object.poses().front().world_from_sensor;
  }
  return out;
}

const pipeline::TracedWorld& WorldData::traced() const {
  std::call_once(prepared_, [this] {
    traced_ = kind_ == FileKind::kModel ? std::make_unique<pipeline::TracedWorld>(scene_.models[0])
                                        : std::make_unique<pipeline::TracedWorld>(scene_, info_);
  });
  return *traced_;
}

const elements::Model& WorldData::model(size_t number) const {
  require(number < scene_.models.size(), "no such model");
  return scene_.models[number];
}

std::string WorldData::json() const {
  nlohmann::ordered_json j;
  j["kind"] = name(kind_);
  j["origin_m"] = {origin_.x(), origin_.y(), origin_.z()};
  j["models"] = nlohmann::ordered_json::array();
  for (size_t k = 0; k < scene_.models.size(); ++k) {
    const elements::Model& m = scene_.models[k];
    j["models"].push_back({{"name", k < info_.names.size() ? info_.names[k] : ""},
                           {"fitter", m.fitter},
                           {"tau", m.tau},
                           {"ellipsoids", m.ellipsoids.size()},
                           {"ground_triangles", m.ground.size()},
                           {"surface_triangles", m.surface.size()}});
  }
  for (size_t k = 0; k < boxes_.size(); ++k) {
    const Vec3 &low = boxes_[k].min, &high = boxes_[k].max;
    j["models"][k]["class"] = elements::name(info_.labels[k]);
    j["models"][k]["box_m"] = {{"min", {low.x(), low.y(), low.z()}},
                               {"max", {high.x(), high.y(), high.z()}}};
  }
  std::set<uint32_t> moving;
  for (const elements::Mover& m : info_.movers) moving.insert(m.instance);
  const std::vector<Pose> poses = first_poses();
  j["instances"] = nlohmann::ordered_json::array();
  for (size_t k = 0; k < scene_.instances.size(); ++k) {
    const elements::Instance& i = scene_.instances[k];
    const Vec3 at = poses[k].translation - origin_;
    const Eigen::Quaterniond& q = poses[k].rotation;
    const auto label = k < info_.labels.size() ? info_.labels[k] : elements::Class::kUnknown;
    j["instances"].push_back({{"model", i.model},
                              {"class", elements::class_name(info_, label)},
                              {"at_m", {at.x(), at.y(), at.z()}},
                              {"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
                              {"scale", i.scale},
                              {"moves", moving.count(uint32_t(k)) != 0}});
  }
  const std::vector<std::string> classes = elements::element_classes(info_);
  j["classes"] = elements::kClassNames;
  if (!classes.empty()) j["classes"] = classes;
  return text_of(j);
}

std::string WorldData::thumbnail(size_t number) const {
  require(kind_ == FileKind::kPrimitives && number < boxes_.size(), "no such primitive");
  const std::filesystem::path name = std::filesystem::path(info_.names[number]) / "thumbnail.png";
  require(!leads_out(folder_, name), "a link that leads out of the folder");
  return read_file(folder_ / name, kMostThumbnail);
}

std::string WorldData::ellipsoids(size_t number) const {
  const elements::Model& m = model(number);
  std::string bytes;
  bytes.reserve(m.ellipsoids.size() * 52);
  for (const elements::Ellipsoid& e : m.ellipsoids) {
    append(bytes, e.mean.data(), 3);
    append(bytes, e.covariance.data(), 6);
    append(bytes, e.hit.p);
    append(bytes, e.hit.hits);
    append(bytes, e.hit.misses);
    append(bytes, e.label);
  }
  return bytes;
}

std::string WorldData::mesh(size_t number, elements::Kind kind) const {
  const elements::TriangleMesh& m = model(number).mesh(kind);
  std::string bytes;
  append(bytes, uint32_t(m.vertices.size()));
  append(bytes, uint32_t(m.size()));
  for (const Vec3f& v : m.vertices) append(bytes, v.data(), 3);
  for (const auto& t : m.triangles) append(bytes, t.data(), 3);
  for (const elements::HitCount& h : m.hit) append(bytes, h.p);
  for (const elements::HitCount& h : m.hit) append(bytes, h.hits);
  for (const elements::HitCount& h : m.hit) append(bytes, h.misses);
  return bytes;
}

}  // namespace underbrush::serve
