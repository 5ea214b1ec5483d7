#include "underbrush/primitives/primitive_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/primitives/contact_sheet.hpp"
#include "underbrush/primitives/object_json.inl"
#include "underbrush/primitives/thumbnail.hpp"

namespace underbrush::primitives {
namespace fs = std::filesystem;
namespace {

constexpr int kThumbnailPixels = 160;

std::vector<PrimitiveEntry> entries_of(const std::vector<Primitive>& primitives) {
  std::vector<PrimitiveEntry> entries;
  std::map<elements::Class, int> count;
  for (const Primitive& p : primitives) {
    char number[16];
    std::snprintf(number, sizeof number, "/%04d", ++count[p.label]);
    entries.push_back({p.label, as_written(p.box), std::string(elements::name(p.label)) + number,
                       p.model.size(), p.source.points, p.source.layers, p.origin, p.source.beams,
                       p.given_name});
  }
  return entries;
}

Json json_of(const PrimitiveEntry& e) {
  Json j;
  j["class"] = elements::name(e.label);
  j["folder"] = e.name;
  if (!e.given_name.empty()) j["name"] = e.given_name;
  j["box_m"] = json_of_box(e.box);
  j["elements"] = e.elements;
  j["points"] = e.points;
  if (e.layers.known()) j["layers_m"] = json_of_layers(e.layers);
  if (e.beams.known()) j["beams"] = json_of_beams(e.beams);
  return j;
}

Json json_of(const PrimitiveOrigin& o) {
  Json j;
  j["set"] = o.set;
  j["site"] = o.site;
  j["season"] = o.season;
  j["sensor"] = o.sensor;
  j["license"] = o.license;
  j["provenance"] = o.provenance.empty() ? Json::object() : io::json_of_text(o.provenance);
  return j;
}

PrimitiveOrigin origin_of(const io::JsonValue& j) {
  return {j.at("set").text(),    j.at("site").text(),    j.at("season").text(),
          j.at("sensor").text(), j.at("license").text(), j.at("provenance").dump()};
}

PlantPlacement plant_of(const io::JsonValue& j) {
  return {j.at("plant").text(),   j.at("foot_m").vector(),  j.at("turn_rad").number(),
          j.at("scale").number(), j.at("yaw_rad").number(), j.at("at_m").vector()};
}

Json json_of(const PlantPlacement& p) {
  Json j;
  j["plant"] = p.plant;
  j["foot_m"] = {p.foot.x(), p.foot.y(), p.foot.z()};
  j["turn_rad"] = p.turn_rad;
  j["scale"] = p.scale;
  j["yaw_rad"] = p.yaw_rad;
  j["at_m"] = {p.at.x(), p.at.y(), p.at.z()};
  return j;
}

// Returns the height (m) that the pictures of each primitive show: that of its class's largest box.
std::vector<double> heights_shown(const std::vector<Primitive>& primitives) {
  std::map<elements::Class, double> largest;
  for (const Primitive& p : primitives) {
    double& m = largest[p.label];
    m = std::max({m, p.box.max.z(), 2 * p.box.max.x(), -2 * p.box.min.x()});
  }
  std::vector<double> out;
  out.reserve(primitives.size());
  for (const Primitive& p : primitives) out.push_back(std::ceil(2 * largest[p.label]) / 2);
  return out;
}

}  // namespace

bool is_primitive_set(const fs::path& path) {
  return fs::is_regular_file(path / "primitives.json");
}

PrimitiveSet primitive_set(std::vector<Primitive> primitives, double cell_m) {
  PrimitiveSet set;
  set.cell_m = cell_m;
  set.entries = entries_of(primitives);
  for (Primitive& p : primitives) set.models.push_back(std::move(p.model));
  return set;
}

void check_primitives_output(const fs::path& path) {
  io::check_output_folder(path, is_primitive_set(path), "no set of primitives");
}

void write_primitives(const fs::path& path, const std::vector<Primitive>& primitives, double cell_m,
                      const std::string& provenance, const std::vector<PrimitiveOrigin>& origins) {
  check_primitives_output(path);
  const std::vector<PrimitiveEntry> entries = entries_of(primitives);
  const std::vector<double> metres = heights_shown(primitives);
  std::vector<std::vector<uint8_t>> pictures(primitives.size());
  parallel_for(primitives.size(), 8, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      pictures[k] = io::png_from_image(thumbnail(primitives[k], kThumbnailPixels, metres[k]));
    }
  });
  Json j;
  j["format"] = "underbrush-primitives";
  j["version"] = kPrimitiveSetVersion;
  j["cell_m"] = cell_m;
  j["primitives"] = Json::array();
  for (const PrimitiveEntry& e : entries) {
    j["primitives"].push_back(json_of(e));
    if (!origins.empty()) j["primitives"].back()["origin"] = e.origin;
  }
  for (const PrimitiveOrigin& o : origins) j["origins"].push_back(json_of(o));
  const Json origin = provenance.empty() ? Json::object() : io::json_of_text(provenance);
  j["provenance"] = origin;
  io::write_atomically(
      path,
      [&](const fs::path& folder) {
        make_temporary_folders(folder);
        for (size_t k = 0; k < entries.size(); ++k) {
          const fs::path one = folder / entries[k].name;
          make_temporary_folders(one.parent_path());
          elements::Model model = primitives[k].model;
          if (model.provenance.empty()) model.provenance = provenance;
          elements::write_model(one, model);
          Json about = json_of(entries[k]);
          about["source"] = json_of_object(primitives[k].source);
          for (const PlantPlacement& p : primitives[k].plants) {
            about["plants"].push_back(json_of(p));
          }
          if (!origins.empty()) about["origin"] = json_of(origins.at(entries[k].origin));
          about["provenance"] = origin;
          write_file(one / "primitive.json", io::text_of_json(about, 1) + "\n");
          write_file(one / "thumbnail.png",
                     {reinterpret_cast<const char*>(pictures[k].data()), pictures[k].size()});
        }
        write_file(folder / "index.html", contact_sheet(entries, pictures, metres));
        write_file(folder / "primitives.json", io::text_of_json(j, 1) + "\n");
      },
      io::OutputKind::kFolder);
}

PrimitiveSet read_primitive_set(const fs::path& path) {
  const fs::path file = path / "primitives.json";
  if (!fs::exists(path)) throw FormatError(path.string(), "", "no such set of primitives");
  if (!is_primitive_set(path)) {
    throw FormatError(path.string(), "", "no set of primitives (no primitives.json in it)");
  }
  const io::JsonFile json(file);
  const io::JsonValue j =
      json.manifest("underbrush-primitives", kPrimitiveSetVersion, "a set of primitives");
  PrimitiveSet set;
  set.folder = path;
  set.cell_m = j.at("cell_m").number();
  set.provenance = j.at("provenance").dump();
  if (const auto origins = j.find("origins")) {
    for (const io::JsonValue& o : origins->values()) set.origins.push_back(origin_of(o));
  }
  for (const io::JsonValue& p : j.at("primitives").values()) {
    PrimitiveEntry e;
    e.label = class_of_json(p);
    e.box = box_of_json(p);
    const io::JsonValue folder = p.at("folder");
    e.name = folder.text();
    e.elements = p.at("elements").count();
    e.points = p.at("points").count();
    e.layers = layers_of_json(p);
    e.beams = beams_of_json(p);
    if (const auto name = p.find("name")) e.given_name = name->text();
    if (!set.origins.empty()) e.origin = uint32_t(p.at("origin").count(set.origins.size() - 1));
    if (!elements::is_model(folder.path())) folder.fail("is not there");
    set.entries.push_back(std::move(e));
  }
  return set;
}

elements::Model read_primitive(const PrimitiveSet& set, size_t entry) {
  if (!set.models.empty()) return set.models.at(entry);
  return elements::read_model(set.folder / set.entries.at(entry).name);
}

Primitive read_whole_primitive(const PrimitiveSet& set, size_t entry) {
  const PrimitiveEntry& e = set.entries.at(entry);
  const io::JsonFile json(set.folder / e.name / "primitive.json");
  const io::JsonValue j = json.root();
  Primitive p{e.label,  e.box,       read_primitive(set, entry), object_of_json(j.at("source")), {},
              e.origin, e.given_name};
  const elements::Class written = class_of_json(j);
  for (elements::Ellipsoid& part : p.model.ellipsoids) {
    if (part.label == uint32_t(written)) part.label = uint32_t(e.label);
  }
  if (const auto plants = j.find("plants")) {
    for (const io::JsonValue& plant : plants->values()) p.plants.push_back(plant_of(plant));
  }
  return p;
}

}  // namespace underbrush::primitives
