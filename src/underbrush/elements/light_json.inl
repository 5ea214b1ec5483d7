/// \file
/// The response of a sensor as JSON. This file is internal to the module.
#pragma once
#include <nlohmann/json.hpp>

#include "underbrush/elements/light.hpp"
#include "underbrush/io/json_file.hpp"

namespace underbrush::elements {

inline nlohmann::ordered_json json_of_gain(const Gain& gain, const char* knots) {
  return {{knots, gain.at}, {"gain", gain.gain}};
}

inline Gain gain_of_json(const io::JsonValue& j, const char* knots) {
  return {j.at(knots).numbers(), j.at("gain").numbers()};
}

inline nlohmann::ordered_json json_of_light(const Light& light) {
  return {{"max_intensity", light.max_intensity},
          {"range", json_of_gain(light.range, "range_m")},
          {"incidence_triangles", json_of_gain(light.incidence[0], "cosine")},
          {"incidence_ellipsoids", json_of_gain(light.incidence[1], "cosine")},
          {"ring_gain", light.ring}};
}

inline Light light_of_json(const io::JsonValue& j) {
  Light light;
  light.max_intensity = j.at("max_intensity").number();
  light.range = gain_of_json(j.at("range"), "range_m");
  light.incidence[0] = gain_of_json(j.at("incidence_triangles"), "cosine");
  light.incidence[1] = gain_of_json(j.at("incidence_ellipsoids"), "cosine");
  light.ring = j.at("ring_gain").numbers();
  return light;
}

}  // namespace underbrush::elements
