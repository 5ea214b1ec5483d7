/// \file
/// This file finds the class that a simulated log reports for the element that a beam met.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::simulate {

/// Finds the value of the column `element_class`: the class of the instance if `instance_labels` (a
/// class for each instance) has one for it, else the label of the ellipsoid, else 0. `model` is
/// that of the instance.
inline uint16_t element_class(const elements::Model& model, const trace::Intersection& met,
                              const std::vector<elements::Class>& instance_labels) {
  if (!instance_labels.empty()) {
    const elements::Class label = instance_labels.at(met.instance);
    if (label != elements::Class::kUnknown) return uint16_t(label);
  }
  const elements::ElementPlace place = model.place(met.element);
  return place.kind == elements::Kind::kEllipsoid ? uint16_t(model.ellipsoids[place.index].label)
                                                  : 0;
}

}  // namespace underbrush::simulate
