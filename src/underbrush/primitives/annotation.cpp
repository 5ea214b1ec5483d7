#include "underbrush/primitives/annotation.hpp"

#include <algorithm>
#include <initializer_list>

#include "underbrush/elements/manifest.inl"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/file.hpp"
#include "underbrush/primitives/object_json.inl"

namespace underbrush::primitives {
namespace fs = std::filesystem;
namespace {

void check_members(const JsonPlace& place, const Json& j,
                   std::initializer_list<const char*> known) {
  if (!j.is_object()) place.fail("expected an object { … }");
  for (const auto& [name, value] : j.items()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_name(name, {known.begin(), known.end()});
    place.fail("unknown member '" + name + "'" +
               (near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
}

uint32_t count_of(const JsonPlace& place, const Json& j) {
  if (!j.is_number_unsigned() || j.get<uint64_t>() > UINT32_MAX) {
    place.fail("expected a whole number from 0 on, found " + j.dump().substr(0, 40));
  }
  return j;
}

PlacedObject object_of(const JsonPlace& place, const Json& j) {
  check_members(
      place, j,
      {"class", "position_m", "yaw_rad", "box_m", "instance", "points", "trajectory", "comment"});
  PlacedObject o;
  o.label = class_of_json(place, j);
  const Json& position = member_of(place, j, "position_m");
  const JsonPlace at = place.at("position_m");
  if (position.is_array() && position.size() == 2) {  // z is the ground's
    o.position = Vec3(number_of_json(at, position[0]), number_of_json(at, position[1]), 0);
  } else {
    o.position = vector_of_json(at, position);
  }
  if (j.contains("yaw_rad")) o.yaw_rad = number_of_json(place.at("yaw_rad"), j["yaw_rad"]);
  o.box = box_of_json(place, j);
  if (j.contains("instance")) o.instance = count_of(place.at("instance"), j["instance"]);
  if (j.contains("points")) o.points = count_of(place.at("points"), j["points"]);
  if (j.contains("trajectory")) {
    if (!j["trajectory"].is_string()) place.at("trajectory").fail("expected a file's name");
    o.trajectory = fs::path(place.file).parent_path() / j["trajectory"].get<std::string>();
  }
  return o;
}

}  // namespace

void write_annotation(const fs::path& path, const Annotation& a) {
  Json j;
  j["format"] = "underbrush-annotation";
  j["version"] = kAnnotationVersion;
  const fs::path folder = fs::absolute(path).parent_path();
  j["ground"] =
      fs::absolute(a.ground).lexically_normal().lexically_relative(folder).generic_string();
  j["provenance"] = a.provenance.empty() ? Json::object() : Json::parse(a.provenance);
  // An object a line: such a file can be read, compared and edited.
  std::string text = j.dump(1);
  text.erase(text.find_last_of('}') - 1);
  text += ",\n \"objects\": [";
  for (size_t k = 0; k < a.objects.size(); ++k) {
    Json object = json_of_object(a.objects[k]);
    if (const fs::path& poses = a.objects[k].trajectory; !poses.empty()) {
      object["trajectory"] =
          fs::absolute(poses).lexically_normal().lexically_relative(folder).generic_string();
    }
    text += (k ? ",\n  " : "\n  ") + object.dump();
  }
  text += a.objects.empty() ? "]\n}\n" : "\n ]\n}\n";
  io::write_atomically(path, text);
}

Annotation read_annotation(const fs::path& path) {
  const std::string text = io::read_file(path);
  const JsonPlace whole{path.string(), ""};
  Json j;
  try {
    j = Json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    const auto end = text.begin() + long(std::min(e.byte, text.size()));
    throw FormatError(path.string(),
                      "line " + std::to_string(1 + std::count(text.begin(), end, '\n')),
                      "not JSON (a NaN is none either): " + std::string(e.what()).substr(0, 160));
  } catch (const nlohmann::json::exception& e) {  // a number beyond all bounds
    throw FormatError(path.string(), "", "not JSON: " + std::string(e.what()).substr(0, 160));
  }
  check_members(whole, j,
                {"format", "version", "ground", "objects", "provenance", "comment", "$schema"});
  elements::check_format(path, member_of(whole, j, "format"), "underbrush-annotation",
                         "an underbrush annotation");
  elements::check_version(
      path, int64_t(count_of({path.string(), "version"}, member_of(whole, j, "version"))),
      kAnnotationVersion);
  Annotation a;
  const Json& ground = member_of(whole, j, "ground");
  if (!ground.is_string()) throw FormatError(path.string(), "ground", "expected a folder's name");
  a.ground = path.parent_path() / ground.get<std::string>();
  const Json& objects = member_of(whole, j, "objects");
  if (!objects.is_array()) throw FormatError(path.string(), "objects", "expected a list [ … ]");
  for (size_t k = 0; k < objects.size(); ++k) {
    a.objects.push_back(
        object_of({path.string(), "objects[" + std::to_string(k) + "]"}, objects[k]));
  }
  if (j.contains("provenance")) a.provenance = j["provenance"].dump();
  return a;
}

}  // namespace underbrush::primitives
