#include "underbrush/fit/effort.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "underbrush/calibrate/light.hpp"
#include "underbrush/likelihood/likelihood.hpp"

namespace underbrush::fit {
namespace {

const std::vector<Effort>& efforts() {
  static const std::vector<Effort> kEfforts{
      {"low", {0, 4}, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 8}}, 2},
      {"medium", {}, likelihood::LikelihoodOptions{}.shares, calibrate::kSamplesOfLight},
      {"high", {}, {{0, 8}}, calibrate::kSamplesOfLight}};
  return kEfforts;
}

}  // namespace

std::vector<std::string_view> effort_names() {
  std::vector<std::string_view> out;
  for (const Effort& e : efforts()) out.push_back(e.name);
  return out;
}

const Effort& effort_named(std::string_view name) {
  const auto found = std::ranges::find(efforts(), name, &Effort::name);
  if (found == efforts().end()) {
    throw std::invalid_argument("fit: there is no effort " + std::string(name));
  }
  return *found;
}

}  // namespace underbrush::fit
