#include "objects_of_log.hpp"

#include <fmt/format.h>

#include "underbrush/core/check.hpp"

namespace underbrush::app {

void require_objects(const std::string& file, BeamSource& log) {
  log.rewind();
  BeamLog chunk;
  log.next(chunk);
  if (!chunk.extra.count("class") || !chunk.extra.count("instance") ||
      log.info().classes != "underbrush") {
    throw FormatError(
        file, "", "has no objects: it needs the columns class and instance that segment writes");
  }
}

std::string left_out(const std::vector<std::pair<std::string, size_t>>& counts) {
  std::string text;
  for (const auto& [what, n] : counts) {
    if (n) text += fmt::format("  left out    {} {}\n", n, what);
  }
  return text;
}

}  // namespace underbrush::app
