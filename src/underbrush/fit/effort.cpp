#include "underbrush/fit/effort.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

#include "underbrush/calibrate/light.hpp"
#include "underbrush/likelihood/likelihood.hpp"

namespace underbrush::fit {
namespace {

using credit::BeamShare;

constexpr BeamShare kFewBeams[] = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 8}}, kAllBeams[] = {{0, 8}};
constexpr Effort kEfforts[] = {{"low", {0, 4}, kFewBeams, 2},
                               {"medium", {}, likelihood::kUsualShares, calibrate::kSamplesOfLight},
                               {"high", {}, kAllBeams, calibrate::kSamplesOfLight}};

}  // namespace

std::vector<std::string_view> effort_names() {
  std::vector<std::string_view> out;
  for (const Effort& e : kEfforts) out.push_back(e.name);
  return out;
}

const Effort& effort_named(std::string_view name) {
  const auto* const found = std::ranges::find(kEfforts, name, &Effort::name);
  if (found == std::end(kEfforts)) {
    throw std::invalid_argument("fit: there is no effort " + std::string(name));
  }
  return *found;
}

}  // namespace underbrush::fit
