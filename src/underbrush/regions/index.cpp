#include "underbrush/regions/index.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/regions/files.hpp"

namespace underbrush::regions {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKinds[] = {"ground", "surface", "ellipsoids"};

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const Region& r) {
  Json j{{"square", {r.square.x, r.square.y}},
         {"bounds_m", {{"min", json_of(r.bounds.min())}, {"max", json_of(r.bounds.max())}}}};
  for (size_t k = 0; k < r.elements.size(); ++k) j[kKinds[k]] = r.elements[k];
  j["instances"] = r.instances;
  j["hash"] = r.hash;
  return j;
}

Region region_of(const io::JsonValue& j) {
  j.check_members({"square", "bounds_m", "ground", "surface", "ellipsoids", "instances", "hash"});
  Region r;
  const std::vector<double> square = j.at("square").numbers();
  constexpr double kMost = 1 << 30;
  if (square.size() != 2) j.at("square").fail("expected two whole numbers");
  for (const double at : square) {
    if (!(std::abs(at) < kMost) || at != std::floor(at)) j.at("square").fail("not a square");
  }
  r.square = {int32_t(square[0]), int32_t(square[1])};
  const io::JsonValue bounds = j.at("bounds_m");
  r.bounds = {bounds.at("min").vector(), bounds.at("max").vector()};
  if (r.bounds.isEmpty()) bounds.fail("min is beyond max");
  for (size_t k = 0; k < r.elements.size(); ++k) {
    r.elements[k] = uint32_t(j.at(kKinds[k]).count(UINT32_MAX));
  }
  r.instances = uint32_t(j.at("instances").count(UINT32_MAX));
  r.hash = j.at("hash").text();
  return r;
}

/// Fails where a whole world would have more elements or instances than rays can distinguish.
void check_counts(const Index& index, const io::JsonValue& regions) {
  constexpr uint64_t kMostElements = 1 << 29;
  uint64_t elements = 0, instances = index.common_instances.size();
  for (const Region& r : index.regions) {
    elements += uint64_t(r.elements[0]) + r.elements[1] + r.elements[2];
    instances += r.instances;
  }
  if (elements + 1 >= kMostElements) regions.fail("more than 2^29 elements");
  if (instances >= UINT32_MAX) regions.fail("more than 2^32 instances");
  for (const uint32_t number : index.common_instances) {
    if (number >= instances)
      regions.fail("fewer instances than the number of a common one requires");
  }
}

}  // namespace

uint64_t Region::bytes() const {
  constexpr uint64_t kTriangle = 130, kEllipsoid = 170, kInstance = 330;
  return kTriangle * (uint64_t(elements[0]) + elements[1]) + kEllipsoid * elements[2] +
         kInstance * instances;
}

std::array<uint32_t, 3> Index::elements() const {
  std::array<uint32_t, 3> sum{};
  for (const Region& r : regions) {
    for (size_t k = 0; k < sum.size(); ++k) sum[k] += r.elements[k];
  }
  return sum;
}

uint32_t Index::instances() const {
  auto sum = uint32_t(common_instances.size());
  for (const Region& r : regions) sum += r.instances;
  return sum;
}

fs::path folder_of(const Cell2& square) {
  return fs::path("regions") / (std::to_string(square.x) + "_" + std::to_string(square.y));
}

bool is_world(const fs::path& path) { return fs::is_regular_file(path / kIndexFile); }

void write_index(const fs::path& path, const Index& index) {
  Json j;
  j["format"] = "underbrush-world";
  j["version"] = kWorldVersion;
  j["kind"] = index.is_scene ? "scene" : "model";
  j["side_m"] = index.side_m;
  for (size_t k = 0; k < index.reflectance.size(); ++k) {
    j["reflectance"][kKinds[k]] = {index.reflectance[k].mean, index.reflectance[k].spread};
  }
  j["common_instances"] = index.common_instances;
  j["provenance"] = index.provenance.empty() ? Json::object() : io::json_of_text(index.provenance);
  // Each region is a line, so that the file can be read and compared.
  std::string text = io::text_of_json(j, 1);
  text.erase(text.find_last_of('}') - 1);
  text += ",\n \"regions\": [";
  for (size_t k = 0; k < index.regions.size(); ++k) {
    text += (k ? ",\n  " : "\n  ") + io::text_of_json(json_of(index.regions[k]));
  }
  write_file(path / kIndexFile, text + "\n ]\n}\n");
}

Index read_index(const fs::path& path) {
  const io::JsonFile json(path / kIndexFile);
  const io::JsonValue j = json.manifest("underbrush-world", kWorldVersion, "an underbrush world");
  j.check_members({"$schema", "format", "version", "comment", "kind", "side_m", "reflectance",
                   "common_instances", "provenance", "regions"});
  Index index;
  const std::string kind = j.at("kind").text();
  if (kind != "scene" && kind != "model") j.at("kind").fail("must be scene or model");
  index.is_scene = kind == "scene";
  index.side_m = j.at("side_m").number();
  if (!(index.side_m > 0)) j.at("side_m").fail("must be positive");
  for (size_t k = 0; k < index.reflectance.size(); ++k) {
    const std::vector<double> of = j.at("reflectance").at(kKinds[k]).numbers();
    if (of.size() != 2) j.at("reflectance").fail("expected a mean and a spread");
    index.reflectance[k] = {of[0], of[1]};
  }
  for (const io::JsonValue& n : j.at("common_instances").values()) {
    index.common_instances.push_back(uint32_t(n.count(UINT32_MAX)));
  }
  for (const io::JsonValue& r : j.at("regions").values()) {
    index.regions.push_back(region_of(r));
  }
  check_counts(index, j.at("regions"));
  index.provenance = j.at("provenance").dump();
  return index;
}

}  // namespace underbrush::regions
