/// \file
/// Label sets: the meaning of the numbers with which data sets label points.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace underbrush::elements {

/// Whether a label means ground.
enum class GroundLabel : uint8_t { kNo, kYes, kUnknown };

/// A label of a set.
struct Label {
  uint32_t number;
  std::string_view name;
  GroundLabel ground;
};

/// Returns the names of the label sets: "underbrush" (`Class`), "semantickitti", "rellis".
std::vector<std::string> label_set_names();

/// Returns the labels of the set of that name; nothing for another name.
///
/// Ground means road, parking, sidewalk, other ground, lane marking and terrain in SemanticKITTI;
/// dirt, grass, asphalt, concrete, puddle and mud in RELLIS; ground and grass in Underbrush's own
/// set.
std::span<const Label> labels_of(std::string_view set);

/// Returns the label's name in the set, or its number as text where the set does not have it.
std::string label_name(std::string_view set, uint32_t number);

/// Returns whether the label means ground; `kUnknown` where the set does not have it.
GroundLabel ground_label(std::string_view set, uint32_t number);

/// Whether the label means trees or shrubs (grass does not count): vegetation and trunk in
/// SemanticKITTI, tree and bush in RELLIS, and shrubs, trees and patches in Underbrush's own set.
bool is_vegetation(std::string_view set, uint32_t number);

}  // namespace underbrush::elements
