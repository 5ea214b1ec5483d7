#include "underbrush/primitives/contact_sheet.hpp"

#include <array>
#include <cstdio>
#include <map>

namespace underbrush::primitives {
namespace {

std::string base64(const std::vector<uint8_t>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
  }
  return out;
}

// A text as HTML shows it.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return out;
}

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Primitives</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem;
  color: #222; background: #fff; }
h2 { margin: 2.2rem 0 .6rem; border-bottom: 1px solid #ccc; }
h2 small { font-weight: normal; color: #555; }
.sheet { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; width: 10rem; }
img { width: 100%; display: block; border: 1px solid #ddd; }
figcaption { font-size: .8rem; color: #444; font-variant-numeric: tabular-nums; }
@media (prefers-color-scheme: dark) { body { color: #ddd; background: #16181c; }
  figcaption, h2 small { color: #aaa; } h2 { border-color: #444; } img { border-color: #333; } }
</style>
</head>
<body>
)";

std::string text(const char* format, auto... values) {
  std::array<char, 512> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

}  // namespace

std::string contact_sheet(std::span<const PrimitiveEntry> entries,
                          std::span<const std::vector<uint8_t>> pictures,
                          std::span<const double> metres) {
  std::map<elements::Class, std::vector<size_t>> by_class;
  for (size_t k = 0; k < entries.size(); ++k) by_class[entries[k].label].push_back(k);
  std::string page = kHead;
  page += text(
      "<h1>Primitives</h1>\n<p>%zu primitives of %zu classes. Each picture shows one from "
      "the side, the brown line is the ground; length × width × height of its box.</p>\n",
      entries.size(), by_class.size());
  for (const auto& [label, members] : by_class) {
    const std::string name(elements::name(label));
    page += text("<h2>%s <small>%zu, pictures %.3g m high</small></h2>\n<div class=\"sheet\">\n",
                 name.c_str(), members.size(), metres[members[0]]);
    for (const size_t k : members) {
      const PrimitiveEntry& e = entries[k];
      const Vec3 s = e.box.size();
      page += "<figure><img loading=\"lazy\" alt=\"" + e.name +
              " from the side\" src=\"data:image/png;base64," + base64(pictures[k]) +
              "\"><figcaption>";
      if (!e.given_name.empty()) page += "<b>" + escaped(e.given_name) + "</b><br>";
      page += text(
          "%s<br>%.1f × %.1f × %.1f m<br>%zu elements, %zu "
          "points</figcaption></figure>\n",
          e.name.c_str(), s.x(), s.y(), s.z(), e.elements, e.points);
    }
    page += "</div>\n";
  }
  return page + "</body>\n</html>\n";
}

}  // namespace underbrush::primitives
