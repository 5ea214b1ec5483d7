#include "underbrush/optimize/parameter.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"

namespace underbrush::optimize {
namespace {

double rounded(double value) {
  char text[32];
  const char* end =
      std::to_chars(text, text + sizeof text, value, std::chars_format::scientific, 3).ptr;
  double out = 0;
  std::from_chars(text, end, out);
  return out;
}

}  // namespace

double value_at(const Parameter& p, double place) {
  const double u = std::clamp(place, 0.0, 1.0);
  const double value = p.scale == Scale::kLinear ? p.low + u * (p.high - p.low)
                                                 : p.low * std::pow(p.high / p.low, u);
  return std::clamp(p.scale == Scale::kWhole ? std::round(value) : rounded(value), p.low, p.high);
}

double place_of(const Parameter& p, double value) {
  const double v = std::clamp(value, p.low, p.high);
  return p.scale == Scale::kLinear ? (v - p.low) / (p.high - p.low)
                                   : std::log(v / p.low) / std::log(p.high / p.low);
}

std::vector<size_t> chosen(std::span<const Parameter> known, std::span<const std::string> names) {
  std::vector<size_t> out;
  for (const std::string& name : names) {
    const auto it = std::find_if(known.begin(), known.end(),
                                 [&](const Parameter& p) { return p.name == name; });
    if (it == known.end()) {
      std::vector<std::string> all;
      for (const Parameter& p : known) all.push_back(p.name);
      const std::string near = nearest_name(name, all);
      std::string listed;
      for (const std::string& n : all) listed += (listed.empty() ? "" : ", ") + n;
      throw std::invalid_argument(
          "optimize: '" + name + "' cannot be tuned here" +
          (near.empty() ? "; there are: " + listed : "; did you mean '" + near + "'?"));
    }
    const size_t k = size_t(it - known.begin());
    if (std::count(out.begin(), out.end(), k)) {
      throw std::invalid_argument("optimize: '" + name + "' is named twice");
    }
    out.push_back(k);
  }
  if (names.empty()) {
    for (size_t k = 0; k < known.size(); ++k) out.push_back(k);
  }
  return out;
}

}  // namespace underbrush::optimize
