#include "underbrush/core/check.hpp"

namespace underbrush {
namespace {
std::string joined(std::string_view file, std::string_view place, std::string_view reason) {
  std::string text(file);
  if (!place.empty()) text.append(": ").append(place);
  return text.append(": ").append(reason);
}
}  // namespace

FormatError::FormatError(std::string_view file, std::string_view place, std::string_view reason)
    : std::runtime_error(joined(file, place, reason)) {}

}  // namespace underbrush
