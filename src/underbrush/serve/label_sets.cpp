#include "underbrush/serve/label_sets.hpp"

#include <array>

#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/label_sets.hpp"

namespace underbrush::serve {
namespace {

// What the sets have in common, and the number of each set for it.
struct Meaning {
  uint32_t underbrush, semantickitti, rellis;
};
constexpr Meaning kGround{1, 72, 1}, kGrass{2, 72, 3}, kShrub{5, 70, 19}, kTree{8, 70, 4};

uint32_t number_of(const Meaning& m, std::string_view set) {
  return set == "underbrush" ? m.underbrush : set == "rellis" ? m.rellis : m.semantickitti;
}

const Meaning* meaning_of(std::string_view set, uint32_t number) {
  using elements::ClassKind;
  if (set == "underbrush") {
    if (number >= elements::kClassNames.size()) return nullptr;
    const ClassKind kind = elements::kind_of(elements::Class(number));
    if (kind == ClassKind::kTree) return &kTree;
    if (kind != ClassKind::kOther) return &kShrub;
    return number == 1 ? &kGround : number == 2 ? &kGrass : nullptr;
  }
  if (set == "rellis" && number == 3) return &kGrass;
  if (set == "rellis" ? number == 4 : number == 71) return &kTree;
  if (elements::is_vegetation(set, number)) return &kShrub;
  return elements::ground_label(set, number) == elements::GroundLabel::kYes ? &kGround : nullptr;
}

}  // namespace

std::optional<uint32_t> place_in_set(std::string_view set, uint32_t number) {
  uint32_t place = 0;
  for (const elements::Label& label : elements::labels_of(set)) {
    if (label.number == number) return place;
    ++place;
  }
  return std::nullopt;
}

std::optional<uint32_t> label_in_set(std::string_view from, uint32_t number, std::string_view to) {
  const auto place = place_in_set(from, number);
  if (!place) return std::nullopt;
  if (from == to || number == 0) return number;
  const std::string_view name = elements::labels_of(from)[*place].name;
  for (const elements::Label& label : elements::labels_of(to)) {
    if (label.name == name) return label.number;
  }
  const Meaning* meaning = meaning_of(from, number);
  return meaning ? std::optional(number_of(*meaning, to)) : std::nullopt;
}

}  // namespace underbrush::serve
