#include "underbrush/serve/head_lines.hpp"

#include <cctype>
#include <string_view>

namespace underbrush::serve {
namespace {

// RFC 9110, 5.6.2: the characters of a header's name.
bool is_token(char c) {
  constexpr std::string_view kMarks = "!#$%&'*+-.^_`|~";
  const auto byte = static_cast<unsigned char>(c);
  return byte < 128 && (std::isalnum(byte) || kMarks.find(c) != kMarks.npos);
}

bool is_text(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return c == '\t' || (byte >= 32 && byte != 127);
}

}  // namespace

bool HeadLines::take(char c) {
  switch (place_) {
    case Place::kRequest:
    case Place::kValue:
      if (c == '\r') place_ = Place::kReturn;
      return c == '\r' || is_text(c);
    case Place::kReturn:
      place_ = empty_ ? Place::kEnd : Place::kStart;
      return c == '\n';
    case Place::kStart:
      empty_ = c == '\r';
      place_ = empty_ ? Place::kReturn : Place::kName;
      return empty_ || is_token(c);
    case Place::kName:
      if (c == ':') place_ = Place::kValue;
      return c == ':' || is_token(c);
    case Place::kEnd:
      return true;
  }
  return false;
}

}  // namespace underbrush::serve
