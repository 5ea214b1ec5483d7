/// \file
/// Small parts that pages and plots share: text as markup, round steps of axes.
#pragma once
#include <string>

namespace underbrush::report {

/// Text in which the special characters of HTML and SVG are escaped.
std::string escaped(const std::string& text);

/// The least of 1, 2 and 5 times a power of ten that is not below `x` > 0.
double round_step_above(double x);
/// The greatest of 1, 2 and 5 times a power of ten that is not above `x` > 0.
double round_step_below(double x);

}  // namespace underbrush::report
