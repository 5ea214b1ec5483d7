#include "underbrush/io/ply_header.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

constexpr uint64_t kMaxHeader = uint64_t(1) << 28;

std::optional<ValueType> type_named(std::string_view name) {
  constexpr const char* kNames[][8] = {
      {"uchar", "ushort", "uint", "char", "short", "int", "float", "double"},
      {"uint8", "uint16", "uint32", "int8", "int16", "int32", "float32", "float64"}};
  for (const auto& names : kNames) {
    for (size_t i = 0; i < 8; ++i) {
      if (name == names[i]) return ValueType(i);
    }
  }
  return std::nullopt;
}

// Reads the header's text block by block, up to and including the line end_header.
std::string header_text(const InputFile& file) {
  std::string text;
  constexpr size_t kHeaderBlock = 1 << 16;
  if (file.size() < 4) throw FormatError(file.name(), "", "is not a PLY file: too short");
  while (true) {
    const size_t old = text.size();
    const size_t more = size_t(std::min<uint64_t>(kHeaderBlock, file.size() - old));
    text.resize(old + more);
    file.read(old, text.data() + old, more);
    if (old == 0 && (text.compare(0, 3, "ply") != 0 || (text[3] != '\n' && text[3] != '\r'))) {
      throw FormatError(file.name(), "line 1", "is not a PLY file: expected 'ply'");
    }
    size_t from = old > 16 ? old - 16 : 0;
    while ((from = text.find("\nend_header", from)) != std::string::npos) {
      const size_t end = text.find_first_not_of('\r', from + 11);
      if (end != std::string::npos && text[end] == '\n') {
        text.resize(end + 1);
        return text;
      }
      from += 1;
    }
    if (text.size() == file.size() || text.size() > kMaxHeader) {
      throw FormatError(file.name(), "header", "no line 'end_header': truncated or not a PLY file");
    }
  }
}

class Parser {
 public:
  explicit Parser(const InputFile& file) : file_(file) {}

  PlyHeader parse() {
    const std::string text = header_text(file_);
    header_.body = text.size();
    for (size_t at = 0; at < text.size();) {
      const size_t end = text.find('\n', at);
      std::string_view line(text.data() + at, end - at);
      while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      ++line_;
      if (line_ > 1) take(line);
      at = end + 1;
    }
    if (!format_seen_) fail("no line 'format'");
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw FormatError(file_.name(), "line " + std::to_string(line_), reason);
  }

  void take(std::string_view line) {
    if (line.substr(0, 7) == "comment") {
      header_.comments.emplace_back(line.size() > 8 ? line.substr(8) : "");
      return;
    }
    const auto words = words_of(line);
    if (words.empty() || words[0] == "end_header" || words[0] == "obj_info") return;
    if (words[0] == "format") {
      take_format(words);
    } else if (words[0] == "element") {
      take_element(words);
    } else if (words[0] == "property") {
      take_property(words);
    } else {
      fail("unknown word '" + std::string(words[0].substr(0, 40)) + "'");
    }
  }

  void take_format(const std::vector<std::string_view>& words) {
    if (words.size() < 2) fail("incomplete format");
    if (words[1] == "ascii") {
      header_.format = PlyHeader::Format::kAscii;
    } else if (words[1] == "binary_little_endian") {
      header_.format = PlyHeader::Format::kLittle;
    } else if (words[1] == "binary_big_endian") {
      header_.format = PlyHeader::Format::kBig;
    } else {
      fail("unknown format");
    }
    format_seen_ = true;
  }

  void take_element(const std::vector<std::string_view>& words) {
    PlyHeader::Element element;
    if (words.size() != 3) fail("expected 'element NAME COUNT'");
    element.name = words[1];
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc() || stop != end) fail("bad count");
    header_.elements.push_back(std::move(element));
  }

  void take_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("property before any element");
    PlyProperty property;
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) fail("expected 'property TYPE NAME'");
    const auto type = type_named(words[words.size() - 2]);
    const auto count_type = list ? type_named(words[2]) : ValueType::kU8;
    if (!type || !count_type || *count_type >= ValueType::kF32) fail("unknown type");
    property.is_list = list;
    property.type = *type;
    property.count_type = *count_type;
    property.name = words.back();
    auto& all = header_.elements.back().properties;
    for (const PlyProperty& other : all) {
      if (other.name == property.name) fail("property '" + property.name + "' twice");
    }
    all.push_back(std::move(property));
  }

  const InputFile& file_;
  PlyHeader header_;
  size_t line_ = 0;
  bool format_seen_ = false;
};

}  // namespace

ExtraColumn column_of(ValueType type) {
  return with_type(type, [](auto zero) { return ExtraColumn(std::vector<decltype(zero)>{}); });
}

const char* ply_name(ValueType type) {
  constexpr const char* kNames[] = {"uchar", "ushort", "uint",  "char",
                                    "short", "int",    "float", "double"};
  return kNames[size_t(type)];
}

size_t PlyHeader::Element::row_size() const {
  size_t size = 0;
  for (const PlyProperty& p : properties) size += size_of(p.is_list ? p.count_type : p.type);
  return size;
}

bool PlyHeader::Element::has_list() const {
  return std::any_of(properties.begin(), properties.end(), [](const auto& p) { return p.is_list; });
}

PlyHeader read_ply_header(const InputFile& file) {
  PlyHeader header = Parser(file).parse();
  uint64_t left = file.size() - header.body;
  for (const auto& element : header.elements) {
    // In ASCII a value takes at least one digit and one separator, which the last value may lack.
    const bool ascii = header.format == PlyHeader::Format::kAscii;
    const uint64_t row = ascii ? 2 * element.properties.size() : element.row_size();
    if (row > 0 && element.count > (left + (ascii ? 1 : 0)) / row) {
      throw FormatError(file.name(), "element " + element.name,
                        "states " + std::to_string(element.count) +
                            " rows, the file holds at most " + std::to_string(left / row) +
                            ": truncated");
    }
    if (row == 0 && element.count > 0) {
      throw FormatError(file.name(), "element " + element.name, "has no properties");
    }
    left -= std::min(left, row * element.count);
  }
  return header;
}

}  // namespace underbrush::io
