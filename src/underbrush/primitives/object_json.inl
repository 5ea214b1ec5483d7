/// \file
/// Objects and boxes as JSON. This file is internal to the module.
#pragma once
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

using Json = nlohmann::ordered_json;

/// A place in a file, for error messages.
struct JsonPlace {
  std::string file, place;
  JsonPlace at(const std::string& member) const { return {file, place + "." + member}; }
  [[noreturn]] void fail(const std::string& reason) const {
    throw FormatError(file, place, reason);
  }
};

inline const Json& member_of(const JsonPlace& place, const Json& j, const char* name) {
  if (!j.is_object()) place.fail("expected an object { … }");
  const auto found = j.find(name);
  if (found == j.end()) place.fail(std::string("has no member '") + name + "'");
  return *found;
}

inline double number_of_json(const JsonPlace& place, const Json& j) {
  if (!j.is_number() || !std::isfinite(j.get<double>())) {
    place.fail("expected a finite number, found " + j.dump().substr(0, 40));
  }
  return j;
}

inline Vec3 vector_of_json(const JsonPlace& place, const Json& j) {
  if (!j.is_array() || j.size() != 3)
    place.fail("expected three numbers, found " + j.dump().substr(0, 40));
  Vec3 v;
  for (size_t d = 0; d < 3; ++d) {
    v[Eigen::Index(d)] =
        number_of_json({place.file, place.place + "[" + std::to_string(d) + "]"}, j[d]);
  }
  return v;
}

inline elements::Class class_of_json(const JsonPlace& place, const Json& j) {
  const Json& name = member_of(place, j, "class");
  if (!name.is_string())
    place.at("class").fail("expected a name, found " + name.dump().substr(0, 40));
  const auto text = name.get<std::string>();
  const auto label = elements::class_from_name(text);
  if (label && elements::kind_of(*label) != elements::ClassKind::kOther) return *label;
  std::vector<std::string> known;
  for (const std::string_view n : elements::kClassNames) {
    if (elements::kind_of(*elements::class_from_name(n)) != elements::ClassKind::kOther) {
      known.emplace_back(n);
    }
  }
  const std::string near = nearest_name(text, known);
  place.at("class").fail("no class of objects '" + text + "'" +
                         (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

/// Reads a box: {"min": [x, y, z], "max": [x, y, z]} in the object's frame, or {"size": [length,
/// width, height]} about its foot.
inline Box box_of_json(const JsonPlace& place, const Json& j) {
  const JsonPlace here = place.at("box_m");
  const Json& b = member_of(place, j, "box_m");
  Box box;
  if (b.is_object() && b.contains("size")) {
    const Vec3 size = vector_of_json(here.at("size"), b["size"]);
    box.min = Vec3(-0.5 * size.x(), -0.5 * size.y(), 0);
    box.max = Vec3(0.5 * size.x(), 0.5 * size.y(), size.z());
  } else {
    box.min = vector_of_json(here.at("min"), member_of(here, b, "min"));
    box.max = vector_of_json(here.at("max"), member_of(here, b, "max"));
  }
  if (!(box.size().minCoeff() > 0)) here.fail("a box without extent: every side must be positive");
  return box;
}

inline Json json_of_vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Json json_of_box(const Box& box) {
  const Box b = as_written(box);
  Json j;
  j["min"] = json_of_vector(b.min);
  j["max"] = json_of_vector(b.max);
  return j;
}

inline Json json_of_object(const PlacedObject& object) {
  const PlacedObject o = as_written(object);
  Json j;
  j["class"] = elements::name(o.label);
  j["position_m"] = json_of_vector(o.position);
  j["yaw_rad"] = o.yaw_rad;
  j["box_m"] = json_of_box(o.box);
  if (o.instance) j["instance"] = o.instance;
  if (o.points) j["points"] = o.points;
  return j;
}

}  // namespace underbrush::primitives
