/// \file
/// Objects and boxes as JSON. This file is internal to the module.
#pragma once
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

using Json = nlohmann::ordered_json;

inline elements::Class class_of_json(const io::JsonValue& object) {
  const io::JsonValue name = object.at("class");
  const std::string text = name.text("a name");
  const auto label = elements::class_from_name(text);
  if (label && elements::kind_of(*label) != elements::ClassKind::kOther) return *label;
  std::vector<std::string> known;
  for (const std::string_view n : elements::kClassNames) {
    if (elements::kind_of(*elements::class_from_name(n)) != elements::ClassKind::kOther) {
      known.emplace_back(n);
    }
  }
  const std::string near = nearest_name(text, known);
  name.fail("no class of objects " + in_quotes(text) +
            (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

/// Reads a box: {"min": [x, y, z], "max": [x, y, z]} in the object's frame, or {"size": [length,
/// width, height]} about its foot.
inline Box box_of_json(const io::JsonValue& object) {
  const io::JsonValue b = object.at("box_m");
  Box box;
  if (const auto size_m = b.find("size")) {
    const Vec3 size = size_m->vector();
    box.min = Vec3(-0.5 * size.x(), -0.5 * size.y(), 0);
    box.max = Vec3(0.5 * size.x(), 0.5 * size.y(), size.z());
  } else {
    box.min = b.at("min").vector();
    box.max = b.at("max").vector();
  }
  if (!(box.size().minCoeff() > 0)) b.fail("a box without extent: every side must be positive");
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

/// A place of points in a box, m.
inline double place_of(const io::JsonValue& list, double place_m) {
  if (!(std::abs(place_m) <= 1e5)) list.fail("must be within 100 km");
  return place_m;
}

inline PointLayers::Places places_of_json(const io::JsonValue& list) {
  PointLayers::Places out;
  const std::vector<double> read = list.numbers();
  if (read.size() != out.size()) list.fail("must have 5 numbers");
  std::ranges::transform(read, out.begin(), [&](double place) { return place_of(list, place); });
  return out;
}
/// Reads the member `layers_m`, or else `quantiles_m`, the places of all points along the axes,
/// which are then those of each layer. Both may be absent.
inline PointLayers layers_of_json(const io::JsonValue& object) {
  PointLayers out;
  if (const auto layers = object.find("layers_m")) {
    layers->check_members({"z", "x", "y"});
    out.z = places_of_json(layers->at("z"));
    for (const auto& [name, to] : {std::pair{"x", &out.x}, {"y", &out.y}}) {
      const std::vector<io::JsonValue> lists = layers->at(name).values();
      if (lists.size() != to->size()) layers->at(name).fail("must have 5 layers");
      for (size_t l = 0; l < lists.size(); ++l) (*to)[l] = places_of_json(lists[l]);
    }
  } else if (const auto list = object.find("quantiles_m")) {
    const std::vector<io::JsonValue> values = list->values();
    if (values.size() != out.z.size()) list->fail("must have 5 places [x, y, z]");
    for (size_t q = 0; q < values.size(); ++q) {
      const Vec3 at = values[q].vector();
      out.z[q] = place_of(*list, at.z());
      for (auto& places : out.x) places[q] = place_of(*list, at.x());
      for (auto& places : out.y) places[q] = place_of(*list, at.y());
    }
  }
  return out;
}
inline Json json_of_layers(const PointLayers& layers) {
  const auto rounded = [](PointLayers::Places places) {
    for (double& x : places) x = as_written(x);
    return places;
  };
  Json j;
  j["z"] = rounded(layers.z);
  for (const auto& [name, from] : {std::pair{"x", &layers.x}, {"y", &layers.y}}) {
    for (const PointLayers::Places& places : *from) j[name].push_back(rounded(places));
  }
  return j;
}

/// Reads the member `beams`, which may be absent.
inline BoxBeams beams_of_json(const io::JsonValue& object) {
  BoxBeams out;
  const auto beams = object.find("beams");
  if (!beams) return out;
  beams->check_members({"returns", "path_m"});
  for (const auto& [name, values] : {std::pair{"returns", &out.returns}, {"path_m", &out.path_m}}) {
    const io::JsonValue list = beams->at(name);
    const std::vector<double> read = list.numbers();
    if (read.size() != values->size()) list.fail("must have 3 numbers");
    for (size_t t = 0; t < read.size(); ++t) {
      if (!(read[t] >= 0 && read[t] < 1e15)) list.fail("must be 0 to 1e15");
      (*values)[t] = read[t];
    }
  }
  return out;
}
inline Json json_of_beams(const BoxBeams& beams) {
  Json j;
  for (const double n : beams.returns) j["returns"].push_back(uint64_t(n));
  j["path_m"] = beams.path_m;
  return j;
}

/// Reads an object. Where its position has x and y only, the ground gives z.
inline PlacedObject object_of_json(const io::JsonValue& j) {
  PlacedObject o;
  o.label = class_of_json(j);
  const std::vector<double> position = j.at("position_m").numbers();
  if (position.size() != 2 && position.size() != 3) {
    j.at("position_m").fail("expected two or three numbers");
  }
  o.position = Vec3(position[0], position[1], position.size() == 3 ? position[2] : 0);
  if (const auto yaw = j.find("yaw_rad")) o.yaw_rad = yaw->number();
  o.box = box_of_json(j);
  if (const auto n = j.find("instance")) o.instance = uint32_t(n->count(UINT32_MAX));
  if (const auto n = j.find("points")) o.points = uint32_t(n->count(UINT32_MAX));
  o.layers = layers_of_json(j);
  o.beams = beams_of_json(j);
  return o;
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
  if (o.layers.known()) j["layers_m"] = json_of_layers(o.layers);
  if (o.beams.known()) j["beams"] = json_of_beams(o.beams);
  return j;
}

}  // namespace underbrush::primitives
