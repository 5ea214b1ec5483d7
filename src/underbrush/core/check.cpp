#include "underbrush/core/check.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>

namespace underbrush {
namespace {

// Returns the bytes of the UTF-8 character at the start of `text`, and its code point; 0 bytes if
// there is none.
size_t character_at(std::string_view text, uint32_t& point) {
  const auto byte = [&](size_t i) { return uint8_t(text[i]); };
  if (byte(0) < 0x80) {
    point = byte(0);
    return 1;
  }
  const size_t n = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < n) return 0;
  point = byte(0) & (0x7F >> n);
  for (size_t i = 1; i < n; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    point = point << 6 | (byte(i) & 0x3F);
  }
  const bool too_long = (n == 3 && point < 0x800) || (n == 4 && point < 0x10000);
  return too_long || point > 0x10FFFF || (point >= 0xD800 && point < 0xE000) ? 0 : n;
}

bool is_shown(uint32_t point) {
  const bool control = point < 0x20 || (point >= 0x7F && point < 0xA0);
  const bool direction = (point >= 0x200E && point <= 0x200F) ||
                         (point >= 0x2028 && point <= 0x202E) ||
                         (point >= 0x2066 && point <= 0x2069);
  return !control && !direction;
}

// Cuts `text` to at most `n` bytes, at the border of a character.
std::string_view head_of(std::string_view text, size_t n) {
  while (n > 0 && n < text.size() && (uint8_t(text[n]) & 0xC0) == 0x80) --n;
  return text.substr(0, n);
}

std::string_view tail_of(std::string_view text, size_t n) {
  size_t begin = text.size() - n;
  while (begin < text.size() && (uint8_t(text[begin]) & 0xC0) == 0x80) ++begin;
  return text.substr(begin);
}

std::string joined(std::string_view file, std::string_view place, std::string_view reason) {
  std::string text(file);
  if (!place.empty()) text.append(": ").append(place);
  return text.append(": ").append(reason);
}
}  // namespace

std::string printable(std::string_view text, size_t limit) {
  constexpr std::string_view kCut = "…";
  std::string out;
  while (!text.empty()) {
    uint32_t point = 0;
    const size_t n = character_at(text, point);
    if (n > 0 && is_shown(point)) {
      out += text.substr(0, n);
    } else {
      char code[8];
      for (size_t i = 0; i < std::max<size_t>(n, 1); ++i) {
        std::snprintf(code, sizeof code, "\\x%02x", uint8_t(text[i]));
        out += code;
      }
    }
    text.remove_prefix(std::max<size_t>(n, 1));
  }
  if (out.size() <= limit) return out;
  const size_t tail = limit / 3, head = limit - tail - kCut.size();
  return std::string(head_of(out, head)).append(kCut).append(tail_of(out, tail));
}

std::string in_quotes(std::string_view word) { return "'" + printable(word, 24) + "'"; }

FormatError::FormatError(std::string_view file, std::string_view place, std::string_view reason)
    : std::runtime_error(joined(file, place, reason)),
      file_(std::make_shared<std::string>(file)),
      place_(std::make_shared<std::string>(place)),
      reason_(std::make_shared<std::string>(reason)) {}

}  // namespace underbrush
