#include "underbrush/io/ply.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/ply_header.hpp"

namespace underbrush::io {
namespace {

using Format = PlyHeader::Format;

bool is_faces(const PlyProperty& p) {
  return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
}

/// Reads the values of a PLY body one after the other.
class Body {
 public:
  Body(const std::string& name, std::string_view bytes, Format format)
      : name_(name), bytes_(bytes), format_(format) {}

  std::string place;  ///< What is being read, for error messages.

  template <class T>
  T next() {
    return format_ == Format::kAscii ? next_text<T>() : next_binary<T>();
  }

  /// Reads a value of a type known only at run time, as an integer that must not be negative.
  uint64_t next_index(ValueType type) {
    return with_type(type, [&](auto zero) {
      const auto value = next<decltype(zero)>();
      if (!(value >= 0) || double(value) > double(std::numeric_limits<uint32_t>::max())) {
        fail("bad number in a list");
      }
      return uint64_t(value);
    });
  }

  [[noreturn]] void fail(const char* reason) const { throw FormatError(name_, place, reason); }
  bool done() {
    if (format_ == Format::kAscii) skip_space();
    return at_ == bytes_.size();
  }
  size_t left() const { return bytes_.size() - at_; }
  const char* take(size_t n) {
    if (n > left()) fail("the file ends here, truncated");
    at_ += n;
    return bytes_.data() + at_ - n;
  }

 private:
  void skip_space() {
    while (at_ < bytes_.size() && (bytes_[at_] == ' ' || (bytes_[at_] >= 9 && bytes_[at_] <= 13))) {
      ++at_;
    }
  }
  template <class T>
  T next_binary() {
    return load<T>(take(sizeof(T)), format_ == Format::kBig);
  }
  template <class T>
  T next_text() {
    skip_space();
    if (at_ == bytes_.size()) fail("the file ends here, truncated");
    double value = 0;  // A double holds the values of every type exactly.
    const char* begin = bytes_.data() + at_;
    const char* end = bytes_.data() + bytes_.size();
    if (*begin == '+') ++begin;
    const auto [stop, error] = std::from_chars(begin, end, value);
    const bool ended = stop == end || *stop == ' ' || (*stop >= 9 && *stop <= 13);
    if (error != std::errc() || !ended) fail("not a number, or outside what a double holds");
    at_ = size_t(stop - bytes_.data());
    if constexpr (std::is_integral_v<T>) {
      if (!(value >= double(std::numeric_limits<T>::min())) ||
          value > double(std::numeric_limits<T>::max())) {
        fail("number outside its type");
      }
    }
    return T(value);
  }

  const std::string& name_;
  std::string_view bytes_;
  size_t at_ = 0;
  Format format_;
};

// Reads rows of fixed width, column after column, without looking up the type of each value.
void read_fixed(Body& body, const PlyHeader::Element& element, bool swap, PlyElement& out) {
  const size_t row = element.row_size(), n = size_t(element.count);
  const char* rows = body.take(row * n);
  for (auto& [name, column] : out.columns) {
    std::visit(
        [&, at = rows](auto& c) mutable {
          using T = typename std::decay_t<decltype(c)>::value_type;
          c.resize(n);
          for (T& value : c) {
            value = load<T>(at, swap);
            at += row;
          }
          rows += sizeof(T);
        },
        column);
  }
}

void read_faces(Body& body, const PlyProperty& list, PlyElement& out) {
  const uint64_t n = body.next_index(list.count_type);
  uint32_t first = 0, previous = 0;
  for (uint64_t k = 0; k < n; ++k) {
    const uint32_t index = uint32_t(body.next_index(list.type));
    if (k == 0) first = index;
    if (k >= 2) out.triangles.push_back({first, previous, index});
    previous = index;
  }
  out.fans.push_back(n < 2 ? 0 : uint32_t(n - 2));
}

void skip_list(Body& body, const PlyProperty& list) {
  const uint64_t n = body.next_index(list.count_type);
  for (uint64_t k = 0; k < n; ++k) {
    with_type(list.type, [&](auto zero) { body.next<decltype(zero)>(); });
  }
}

void read_rows(Body& body, const PlyHeader::Element& element, PlyElement& out) {
  for (uint64_t i = 0; i < element.count; ++i) {
    body.place = element.name + " " + std::to_string(i);
    size_t c = 0;
    for (const PlyProperty& p : element.properties) {
      if (is_faces(p)) {
        read_faces(body, p, out);
      } else if (p.is_list) {
        skip_list(body, p);
      } else {
        std::visit(
            [&](auto& column) {
              using T = typename std::decay_t<decltype(column)>::value_type;
              column.push_back(body.next<T>());
            },
            out.columns[c++].second);
      }
    }
  }
}

void check_triangles(const std::string& name, const PlyData& data) {
  const PlyElement* vertex = data.find("vertex");
  for (const PlyElement& element : data.elements) {
    for (size_t i = 0; i < element.triangles.size(); ++i) {
      for (uint32_t index : element.triangles[i]) {
        if (vertex && index < vertex->count) continue;
        throw FormatError(name, element.name + ": triangle " + std::to_string(i),
                          "vertex " + std::to_string(index) + " does not exist");
      }
    }
  }
}

template <class T>
void put_value(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

size_t rows_of(const PlyElement& element) {
  const size_t n =
      element.columns.empty() ? element.triangles.size() : length_of(element.columns[0].second);
  for (const auto& [name, column] : element.columns) {
    require(length_of(column) == n, "ply: columns of different lengths");
    require(!name.empty() && name.find_first_of(" \t\r\n") == std::string::npos,
            "ply: a column's name must be one word");
  }
  require(element.triangles.empty() || element.triangles.size() == n,
          "ply: as many triangles as rows, or none");
  return n;
}

}  // namespace

const ExtraColumn* PlyElement::find(const std::string& column) const {
  for (const auto& [key, value] : columns) {
    if (key == column) return &value;
  }
  return nullptr;
}

const PlyElement* PlyData::find(const std::string& element) const {
  for (const PlyElement& e : elements) {
    if (e.name == element) return &e;
  }
  return nullptr;
}

const PlyElement& element_of(const std::filesystem::path& file, const PlyData& data,
                             const std::string& name) {
  const PlyElement* element = data.find(name);
  if (!element) throw FormatError(file.string(), "", "no element " + name);
  return *element;
}

PlyData read_ply(const std::filesystem::path& path) {
  const InputFile file(path);
  PlyHeader header = read_ply_header(file);
  const auto size = size_t(file.size() - header.body);
  const auto bytes = std::make_unique_for_overwrite<char[]>(size);
  file.read(header.body, bytes.get(), size);
  Body body(file.name(), {bytes.get(), size}, header.format);
  PlyData data;
  data.comments = std::move(header.comments);
  for (const auto& element : header.elements) {
    PlyElement out;
    out.name = element.name;
    out.count = size_t(element.count);
    for (const PlyProperty& p : element.properties) {
      if (!p.is_list) out.columns.emplace_back(p.name, column_of(p.type));
    }
    body.place = "element " + element.name;
    if (header.format != Format::kAscii && !element.has_list()) {
      read_fixed(body, element, header.format == Format::kBig, out);
    } else {
      read_rows(body, element, out);
    }
    data.elements.push_back(std::move(out));
  }
  body.place = "after the last element";
  if (!body.done()) body.fail("bytes that no element claims");
  check_triangles(file.name(), data);
  return data;
}

void write_ply(const std::filesystem::path& path, const PlyData& data) {
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : data.comments) {
    require(comment.find_first_of("\r\n") == std::string::npos, "ply: a comment must be one line");
    out += "comment " + comment + "\n";
  }
  for (const PlyElement& element : data.elements) {
    out += "element " + element.name + " " + std::to_string(rows_of(element)) + "\n";
    for (const auto& [name, column] : element.columns) {
      out += std::string("property ") + ply_name(type_of(column)) + " " + name + "\n";
    }
    if (!element.triangles.empty()) out += "property list uchar int vertex_indices\n";
  }
  out += "end_header\n";
  for (const PlyElement& element : data.elements) {
    const size_t n = rows_of(element);
    for (size_t i = 0; i < n; ++i) {
      for (const auto& [name, column] : element.columns) {
        std::visit([&](const auto& c) { put_value(out, c[i]); }, column);
      }
      if (element.triangles.empty()) continue;
      put_value(out, uint8_t(3));
      for (uint32_t index : element.triangles[i]) put_value(out, index);
    }
  }
  write_atomically(path, {out.data(), out.size()});
}

}  // namespace underbrush::io
