#include "underbrush/elements/label_sets.hpp"

#include <algorithm>
#include <array>

#include "underbrush/elements/classes.hpp"

namespace underbrush::elements {
namespace {

using enum GroundLabel;

constexpr Label kSemanticKitti[] = {
    {0, "unlabelled", kUnknown},
    {1, "outlier", kUnknown},
    {10, "car", kNo},
    {11, "bicycle", kNo},
    {13, "bus", kNo},
    {15, "motorcycle", kNo},
    {16, "on_rails", kNo},
    {18, "truck", kNo},
    {20, "other_vehicle", kNo},
    {30, "person", kNo},
    {31, "bicyclist", kNo},
    {32, "motorcyclist", kNo},
    {40, "road", kYes},
    {44, "parking", kYes},
    {48, "sidewalk", kYes},
    {49, "other_ground", kYes},
    {50, "building", kNo},
    {51, "fence", kNo},
    {52, "other_structure", kNo},
    {60, "lane_marking", kYes},
    {70, "vegetation", kNo},
    {71, "trunk", kNo},
    {72, "terrain", kYes},
    {80, "pole", kNo},
    {81, "traffic_sign", kNo},
    {99, "other_object", kNo},
    {252, "moving_car", kNo},
    {253, "moving_bicyclist", kNo},
    {254, "moving_person", kNo},
    {255, "moving_motorcyclist", kNo},
    {256, "moving_on_rails", kNo},
    {257, "moving_bus", kNo},
    {258, "moving_truck", kNo},
    {259, "moving_other_vehicle", kNo},
};

constexpr Label kRellis[] = {
    {0, "void", kUnknown}, {1, "dirt", kYes},     {3, "grass", kYes},    {4, "tree", kNo},
    {5, "pole", kNo},      {6, "water", kNo},     {7, "sky", kNo},       {8, "vehicle", kNo},
    {9, "object", kNo},    {10, "asphalt", kYes}, {12, "building", kNo}, {15, "log", kNo},
    {17, "person", kNo},   {18, "fence", kNo},    {19, "bush", kNo},     {23, "concrete", kYes},
    {27, "barrier", kNo},  {31, "puddle", kYes},  {33, "mud", kYes},     {34, "rubble", kNo},
};

constexpr auto kOurs = [] {
  std::array<Label, kClassNames.size()> labels{};
  for (uint32_t k = 0; k < labels.size(); ++k) {
    const auto c = Class(k);
    labels[k] = {k, name(c),
                 c == Class::kUnknown                        ? kUnknown
                 : c == Class::kGround || c == Class::kGrass ? kYes
                                                             : kNo};
  }
  return labels;
}();

const Label* find(std::string_view set, uint32_t number) {
  for (const Label& label : labels_of(set)) {
    if (label.number == number) return &label;
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> label_set_names() { return {"underbrush", "semantickitti", "rellis"}; }

std::span<const Label> labels_of(std::string_view set) {
  if (set == "underbrush") return kOurs;
  if (set == "semantickitti") return kSemanticKitti;
  if (set == "rellis") return kRellis;
  return {};
}

std::string label_name(std::string_view set, uint32_t number) {
  const Label* label = find(set, number);
  return label ? std::string(label->name) : std::to_string(number);
}

GroundLabel ground_label(std::string_view set, uint32_t number) {
  const Label* label = find(set, number);
  return label ? label->ground : kUnknown;
}

bool is_vegetation(std::string_view set, uint32_t number) {
  if (set == "semantickitti") return number == 70 || number == 71;
  if (set == "rellis") return number == 4 || number == 19;
  return set == "underbrush" && number < kClassNames.size() &&
         kind_of(Class(number)) != ClassKind::kOther;
}

}  // namespace underbrush::elements
