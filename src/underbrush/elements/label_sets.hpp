/// \file
/// What the numbers mean by which people label points.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace underbrush::elements {

/// What a label says of the ground.
enum class GroundLabel : uint8_t { kNo, kYes, kUnknown };

/// One label of a set.
struct Label {
  uint32_t number;
  std::string_view name;
  GroundLabel ground;
};

/// Names of the label sets: "underbrush" (`Class`), "semantickitti", "rellis".
std::vector<std::string> label_set_names();

/// The labels of the set of that name; none for another name.
///
/// Ground in SemanticKITTI: road, parking, sidewalk, other ground, lane marking, terrain; in
/// RELLIS: dirt, grass, asphalt, concrete, puddle, mud; of ours: ground, grass.
std::span<const Label> labels_of(std::string_view set);

/// The label's name in the set, or its number as text.
std::string label_name(std::string_view set, uint32_t number);

/// What the label says of the ground: `kUnknown` where the set does not have it.
GroundLabel ground_label(std::string_view set, uint32_t number);

/// Whether the label is one of trees or shrubs (grass is not): vegetation and trunk in
/// SemanticKITTI, tree and bush in RELLIS, shrubs, trees and patches of ours.
bool is_vegetation(std::string_view set, uint32_t number);

}  // namespace underbrush::elements
