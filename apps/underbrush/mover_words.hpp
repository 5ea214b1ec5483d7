/// \file
/// The words of `simulate --mover`.
#pragma once
#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush::app {

/// An object that moves, as the command line names it.
struct MoverWords {
  std::string model, poses, material;
};

/// Splits MODEL:POSES[:MATERIAL]. Throws `std::invalid_argument`.
inline MoverWords mover_words(const std::string& text) {
  const size_t first = text.find(':');
  const size_t second = first == std::string::npos ? first : text.find(':', first + 1);
  require(first != std::string::npos && first > 0 && first + 1 < text.size(),
          "simulate: --mover takes MODEL:POSES.txt or MODEL:POSES.txt:MATERIAL");
  MoverWords w{text.substr(0, first), text.substr(first + 1, second - first - 1), ""};
  if (second != std::string::npos) w.material = text.substr(second + 1);
  return w;
}

}  // namespace underbrush::app
