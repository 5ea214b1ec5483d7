#include <lzf.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/log_layout.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

struct PcdField {
  std::string name;
  size_t size = 4, count = 1;
  char type = 'F';
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::optional<Pose> viewpoint;
  uint64_t points = 0;
  std::string data;
  size_t body = 0;

  size_t row_size() const {
    size_t row = 0;
    for (const PcdField& f : fields) row += f.size * f.count;
    return row;
  }
};

/// Parses a PCD header.
class PcdParser {
 public:
  PcdParser(const std::string& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  PcdHeader parse() {
    while (header_.data.empty()) {
      const size_t end = bytes_.find('\n', at_);
      ++line_;
      if (end == std::string_view::npos) fail(line_ == 1 ? "is not a PCD file" : "no line DATA");
      std::string_view line = bytes_.substr(at_, std::min<size_t>(end - at_, 1 << 16));
      if (const size_t hash = line.find('#'); hash != line.npos) line = line.substr(0, hash);
      at_ = end + 1;
      const auto words = words_of(line);
      if (!words.empty()) take(std::string(words[0]), {words.begin() + 1, words.end()});
    }
    if (header_.fields.empty()) fail("no line FIELDS");
    for (const PcdField& f : header_.fields) {
      if (f.name != "_" && f.type == 'F' && f.size < 4) fail("a field of TYPE F needs SIZE 4 or 8");
    }
    if (!points_seen_) header_.points = width_ * height_;
    header_.body = at_;
    if (header_.row_size() == 0) fail("fields without a size");
    return std::move(header_);
  }

 private:
  using Words = std::vector<std::string_view>;
  [[noreturn]] void fail(const std::string& reason) const {
    throw FormatError(file_, "line " + std::to_string(line_), reason);
  }

  uint64_t whole(std::string_view word, uint64_t most) const {
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || value > most) {
      fail("bad number '" + std::string(word.substr(0, 40)) + "'");
    }
    return value;
  }

  void take(const std::string& key, const Words& words) {
    constexpr uint64_t kMost = uint64_t(1) << 40;
    const bool per_field = key == "SIZE" || key == "TYPE" || key == "COUNT";
    if (per_field && words.size() != header_.fields.size()) fail(key + ": one value a field");
    if ((key == "WIDTH" || key == "HEIGHT" || key == "POINTS" || key == "DATA") &&
        words.size() != 1) {
      fail(key + ": expected one value");
    }
    if (key == "FIELDS" || key == "COLUMNS") {
      for (const auto& word : words) {
        const bool again = std::ranges::any_of(
            header_.fields, [&](const PcdField& f) { return f.name == word && word != "_"; });
        if (again) fail("field " + in_quotes(std::string(word)) + " twice");
        header_.fields.push_back({std::string(word)});
      }
    } else if (key == "SIZE") {
      for (size_t i = 0; i < words.size(); ++i) {
        const uint64_t size = whole(words[i], 8);
        if (size != 1 && size != 2 && size != 4 && size != 8) fail("SIZE must be 1, 2, 4 or 8");
        header_.fields[i].size = size_t(size);
      }
    } else if (key == "TYPE") {
      for (size_t i = 0; i < words.size(); ++i) {
        header_.fields[i].type = words[i][0];
        if (words[i] != "F" && words[i] != "U" && words[i] != "I") fail("TYPE must be F, U or I");
      }
    } else if (key == "COUNT") {
      for (size_t i = 0; i < words.size(); ++i) {
        header_.fields[i].count = size_t(whole(words[i], 4096));
      }
    } else if (key == "WIDTH") {
      width_ = whole(words[0], 1 << 20 << 11);
    } else if (key == "HEIGHT") {
      height_ = whole(words[0], 1 << 20);
    } else if (key == "POINTS") {
      header_.points = whole(words[0], kMost);
      points_seen_ = true;
    } else if (key == "VIEWPOINT") {
      take_viewpoint(words);
    } else if (key == "DATA") {
      header_.data = words[0];
      if (words[0] != "ascii" && words[0] != "binary" && words[0] != "binary_compressed") {
        fail("DATA must be ascii, binary or binary_compressed");
      }
    } else if (key != "VERSION") {
      fail(line_ == 1 ? "is not a PCD file" : "unknown word '" + key.substr(0, 40) + "'");
    }
  }

  void take_viewpoint(const Words& words) {
    double v[7] = {};
    if (words.size() != 7) fail("VIEWPOINT: expected 7 numbers");
    for (size_t i = 0; i < 7; ++i) {
      const auto value = number_of(words[i]);
      if (!value || !std::isfinite(*value)) fail("VIEWPOINT: expected 7 numbers");
      v[i] = *value;
    }
    Pose pose{{v[3], v[4], v[5], v[6]}, {v[0], v[1], v[2]}};
    if (std::abs(pose.rotation.norm() - 1) > 5e-3) fail("VIEWPOINT: quaternion's length is not 1");
    pose.rotation.normalize();
    if (!is_within(pose.translation, kMaxCoordinate)) {
      fail("VIEWPOINT: a log cannot hold positions so far away");
    }
    if (pose.translation.isZero() && std::abs(pose.rotation.w()) == 1) return;
    header_.viewpoint = pose;
  }

  const std::string& file_;
  std::string_view bytes_;
  PcdHeader header_;
  size_t at_ = 0, line_ = 0;
  uint64_t width_ = 0, height_ = 1;
  bool points_seen_ = false;
};

// Returns the type of a column that comes nearest to the field's.
ValueType column_type(const PcdField& field) {
  if (field.size == 8) return ValueType::kF64;
  if (field.type == 'F') return ValueType::kF32;
  const int log2 = field.size == 1 ? 0 : field.size == 2 ? 1 : 2;
  return ValueType((field.type == 'U' ? 0 : 3) + log2);
}

double load_wide(const char* at, char type) {
  if (type == 'F') return load<double>(at);
  return type == 'U' ? double(load<uint64_t>(at)) : double(load<int64_t>(at));
}

/// Adds the columns of a field. Element `i` lies at `first + i * stride`.
void add_columns(const PcdField& field, const char* first, size_t element_step, size_t stride,
                 size_t n, Table& table) {
  if (field.name == "_") return;  // padding
  for (size_t k = 0; k < field.count; ++k) {
    ExtraColumn column = column_of(column_type(field));
    std::visit(
        [&](auto& c) {
          using T = typename std::decay_t<decltype(c)>::value_type;
          c.resize(n);
          const char* at = first + k * element_step;
          for (size_t i = 0; i < n; ++i, at += stride) {
            c[i] = field.size == 8 ? T(load_wide(at, field.type)) : load<T>(at);
          }
        },
        column);
    table.columns.emplace_back(field.count == 1 ? field.name : field.name + "_" + std::to_string(k),
                               std::move(column));
  }
}

std::string decompressed(const std::string& file, std::string_view body, uint64_t expected) {
  constexpr uint64_t kLargestRatio = 100;  // LZF makes at most 264 bytes from 3.
  if (body.size() < 8) throw FormatError(file, "DATA", "the file ends here, truncated");
  const uint32_t packed = load<uint32_t>(body.data()), whole = load<uint32_t>(body.data() + 4);
  if (packed > body.size() - 8) throw FormatError(file, "DATA", "compressed data truncated");
  if (whole != expected || whole > kLargestRatio * packed) {
    throw FormatError(file, "DATA", "compressed size and number of points disagree");
  }
  std::string out(whole, '\0');
  if (lzf_decompress(body.data() + 8, packed, out.data(), whole) != whole) {
    throw FormatError(file, "DATA", "compressed data damaged");
  }
  return out;
}

Table read_ascii(const std::string& file, const PcdHeader& header, std::string_view body) {
  Table table;
  std::vector<size_t> places;  // Column of each value in a line.
  for (const PcdField& f : header.fields) {
    for (size_t k = 0; k < f.count; ++k) places.push_back(f.name == "_" ? SIZE_MAX : 0);
    add_columns(f, nullptr, 0, 0, 0, table);
  }
  size_t column = 0;
  for (size_t& place : places) {
    if (place == 0) place = column++;
  }
  size_t at = 0;
  for (uint64_t i = 0; i < header.points; ++i) {
    const std::string place = "point " + std::to_string(i);
    if (at >= body.size()) throw FormatError(file, place, "the file ends here, truncated");
    const size_t end = std::min(body.find('\n', at), body.size());
    const auto words = words_of(body.substr(at, end - at));
    at = end + 1;
    if (words.size() != places.size()) {
      throw FormatError(file, place, "expected " + std::to_string(places.size()) + " values");
    }
    for (size_t k = 0; k < places.size(); ++k) {
      if (places[k] == SIZE_MAX) continue;
      const auto value = number_of(words[k]);
      if (!value) throw FormatError(file, place, "not a number");
      std::visit(
          [&](auto& c) {
            using T = typename std::decay_t<decltype(c)>::value_type;
            if constexpr (std::is_integral_v<T>) {
              if (!(*value >= double(std::numeric_limits<T>::min())) ||
                  *value > double(std::numeric_limits<T>::max())) {
                throw FormatError(file, place, "number outside its type");
              }
            }
            c.push_back(T(*value));
          },
          table.columns[places[k]].second);
    }
  }
  return table;
}

}  // namespace

Table read_pcd(const std::filesystem::path& path) {
  const std::string name = path.string(), bytes = read_file(path);
  const PcdHeader header = PcdParser(name, bytes).parse();
  std::string_view body = std::string_view(bytes).substr(header.body);
  const uint64_t row = header.row_size(), size = row * header.points;
  Table table;
  if (header.data == "ascii") {
    table = read_ascii(name, header, body);
  } else {
    const bool packed = header.data == "binary_compressed";
    const std::string unpacked = packed ? decompressed(name, body, size) : std::string();
    if (packed) body = unpacked;
    if (header.points > body.size() / row) {
      throw FormatError(name, "DATA",
                        "states " + std::to_string(header.points) + " points, the file holds " +
                            std::to_string(body.size() / row) + ": truncated");
    }
    if (!packed && body.size() / row > header.points) {
      table.notes.push_back("the file holds " + std::to_string(body.size() / row - header.points) +
                            " more points than its header states: they are left out");
    }
    const size_t n = size_t(header.points);
    const char* at = body.data();
    for (const PcdField& f : header.fields) {
      // Compressed data holds all values of a field together; other data goes row by row.
      const size_t width = f.size * f.count;
      add_columns(f, at, f.size, packed ? width : size_t(row), n, table);
      at += packed ? width * n : width;
    }
  }
  table.viewpoint = header.viewpoint;
  return table;
}

}  // namespace underbrush::io
