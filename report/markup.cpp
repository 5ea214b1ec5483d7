#include "report/markup.hpp"

#include <cmath>

namespace underbrush::report {
namespace {

double power_of_ten_below(double x) { return std::pow(10, std::floor(std::log10(x))); }

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

double round_step_above(double x) {
  const double power = power_of_ten_below(x);
  for (const double m : {1.0, 2.0, 5.0}) {
    if (x <= m * power) return m * power;
  }
  return 10 * power;
}

double round_step_below(double x) {
  const double power = power_of_ten_below(x);
  return power * (x >= 5 * power ? 5 : x >= 2 * power ? 2 : 1);
}

}  // namespace underbrush::report
