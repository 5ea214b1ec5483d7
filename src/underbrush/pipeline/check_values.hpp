/// \file
/// What checks of imported logs share.
#pragma once
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "underbrush/core/median.hpp"
#include "underbrush/core/pose.hpp"

namespace underbrush::pipeline {

/// A number in the format of `printf`.
inline std::string text_of(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

/// Whether a point of a scan is a return.
inline bool is_return(const Vec3f& p) { return p.allFinite() && !p.isZero(); }

}  // namespace underbrush::pipeline
