#include <charconv>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {
namespace {

struct NumpyField {
  std::string name;
  char kind = 'f';
  size_t size = 4;
};

/// Parses the dictionary that describes a .npy array: {'descr': …, 'fortran_order': …, 'shape': …}.
class NumpyHeader {
 public:
  NumpyHeader(const std::string& file, std::string_view text) : file_(file), text_(text) {
    if (value_of("'fortran_order'").substr(0, 5) != "False") {
      fail("is stored column by column: write numpy.ascontiguousarray(points)");
    }
    read_shape(value_of("'shape'"));
    const std::string_view descr = value_of("'descr'");
    if (descr.substr(0, 1) == "[") {
      read_fields(descr.substr(1));
      if (width != 1) fail("expected a list of records");
    } else {
      constexpr const char* kNames[] = {"x", "y", "z", "intensity", "ring"};
      if (width < 3 || width > 5) fail("expected an array of shape (n, 3 to 5), a row a point");
      for (size_t k = 0; k < width; ++k) add(kNames[k], in_quotes(descr));
    }
  }

  std::vector<NumpyField> fields;
  uint64_t rows = 1, width = 1;

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw FormatError(file_, "header", reason);
  }

  std::string_view value_of(const char* key) const {
    const size_t at = text_.find(key);
    const size_t colon = at == text_.npos ? at : text_.find(':', at);
    const size_t begin = colon == text_.npos ? colon : text_.find_first_not_of(' ', colon + 1);
    if (begin == text_.npos) fail("not a .npy header");
    return text_.substr(begin);
  }

  std::string_view in_quotes(std::string_view text) const {
    const size_t begin = text.find('\'');
    const size_t end = begin == text.npos ? begin : text.find('\'', begin + 1);
    if (end == text.npos) fail("not a .npy header");
    return text.substr(begin + 1, end - begin - 1);
  }

  void add(std::string_view name, std::string_view type) {
    const bool ok = type.size() == 3 && (type[0] == '<' || type[0] == '|') &&
                    (type[1] == 'f' || type[1] == 'u' || type[1] == 'i') &&
                    (type[2] == '1' || type[2] == '2' || type[2] == '4' || type[2] == '8') &&
                    !(type[1] == 'f' && type[2] < '4');
    if (!ok) {
      fail("type " + underbrush::in_quotes(std::string(type)) +
           " is not read: write points.astype('<f4'), or fields of such numbers");
    }
    fields.push_back({std::string(name), type[1], size_t(type[2] - '0')});
  }

  void read_fields(std::string_view text) {
    const size_t list_end = text.find(']');
    if (list_end == text.npos) fail("not a .npy header");
    text = text.substr(0, list_end);
    for (size_t at; (at = text.find('(')) != text.npos;) {
      text.remove_prefix(at + 1);
      const size_t close = text.find(')');
      if (close == text.npos) fail("not a .npy header");
      const std::string_view pair = text.substr(0, close);
      if (pair.find('(') != pair.npos) fail("fields that are arrays are not read");
      const std::string_view name = in_quotes(pair);
      add(name, in_quotes(pair.substr(size_t(name.data() - pair.data()) + name.size() + 1)));
      text.remove_prefix(close + 1);
    }
    if (fields.empty()) fail("no fields");
  }

  void read_shape(std::string_view text) {
    if (text.substr(0, 1) != "(") fail("not a .npy header");
    std::vector<uint64_t> dims;
    const char* at = text.data() + 1;
    const char* const end = text.data() + text.size();
    while (at != end && *at != ')') {
      if (*at == ',' || *at == ' ') {
        ++at;
        continue;
      }
      uint64_t dim = 0;
      const auto [stop, error] = std::from_chars(at, end, dim);
      if (error != std::errc() || dim > uint64_t(1) << 40) fail("bad shape");
      dims.push_back(dim);
      at = stop;
    }
    if (dims.empty() || dims.size() > 2) fail("expected an array with 1 or 2 dimensions");
    rows = dims[0];
    if (dims.size() == 2) width = dims[1];
  }

  const std::string& file_;
  std::string_view text_;
};

Table read_array(const std::string& file, std::string_view bytes) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  if (bytes.size() < 12 || bytes.substr(0, 6) != kMagic) {
    throw FormatError(file, "byte 0", "is not a .npy array");
  }
  const bool long_header = bytes[6] >= 2;
  const size_t begin = long_header ? 12 : 10;
  const size_t length =
      long_header ? load<uint32_t>(bytes.data() + 8) : load<uint16_t>(bytes.data() + 8);
  if (length > bytes.size() - begin) throw FormatError(file, "header", "truncated");
  const NumpyHeader header(file, bytes.substr(begin, length));
  const std::string_view body = bytes.substr(begin + length);
  size_t row = 0;
  for (const NumpyField& f : header.fields) row += f.size;
  if (header.rows > body.size() / row) {
    throw FormatError(file, "data", "states " + std::to_string(header.rows) + " rows: truncated");
  }
  Table table;
  const size_t n = size_t(header.rows);
  size_t offset = 0;
  for (const NumpyField& f : header.fields) {
    const int log2 = f.size == 1 ? 0 : f.size == 2 ? 1 : 2;
    ExtraColumn column = column_of(f.size == 8     ? ValueType::kF64
                                   : f.kind == 'f' ? ValueType::kF32
                                                   : ValueType((f.kind == 'u' ? 0 : 3) + log2));
    std::visit(
        [&](auto& c) {
          using T = typename std::decay_t<decltype(c)>::value_type;
          c.resize(n);
          const char* at = body.data() + offset;
          for (size_t i = 0; i < n; ++i, at += row) {
            c[i] = f.size < 8      ? load<T>(at)
                   : f.kind == 'f' ? T(load<double>(at))
                   : f.kind == 'u' ? T(load<uint64_t>(at))
                                   : T(load<int64_t>(at));
          }
        },
        column);
    table.columns.emplace_back(f.name, std::move(column));
    offset += f.size;
  }
  if (header.width > 3) {
    table.notes.push_back("the array's " + std::to_string(header.width) +
                          " columns are taken to be x y z intensity" +
                          (header.width > 4 ? " ring" : ""));
  }
  return table;
}

// Returns the single array of a .npz file: a zip archive whose entries are not compressed.
std::string_view only_entry(const std::string& file, std::string_view zip) {
  constexpr size_t kDirectory = 46, kLocal = 30, kEnd = 22;
  const auto fail = [&](const char* reason) { throw FormatError(file, "zip", reason); };
  size_t end = zip.rfind("PK\5\6");
  if (end == zip.npos || zip.size() - end < kEnd) fail("no end of the directory: truncated");
  const size_t entries = load<uint16_t>(zip.data() + end + 10);
  const size_t at = load<uint32_t>(zip.data() + end + 16);
  if (entries != 1) fail("expected one array in it");
  if (at > zip.size() - kDirectory || zip.substr(at, 4) != "PK\1\2") fail("directory damaged");
  const char* entry = zip.data() + at;
  if (load<uint16_t>(entry + 10) != 0) fail("compressed arrays are not read: use numpy.savez");
  const size_t size = load<uint32_t>(entry + 24), local = load<uint32_t>(entry + 42);
  if (zip.size() < kLocal || local > zip.size() - kLocal || zip.substr(local, 4) != "PK\3\4") {
    fail("entry damaged");
  }
  const size_t begin = local + kLocal + load<uint16_t>(zip.data() + local + 26) +
                       load<uint16_t>(zip.data() + local + 28);
  if (begin > zip.size() || size > zip.size() - begin) fail("entry truncated");
  return zip.substr(begin, size);
}

}  // namespace

Table read_numpy(const std::filesystem::path& path) {
  const std::string name = path.string(), bytes = read_file(path);
  if (bytes.compare(0, 4, "PK\3\4") != 0) return read_array(name, bytes);
  if (bytes.size() < 76) throw FormatError(name, "zip", "truncated");
  return read_array(name, only_entry(name, bytes));
}

}  // namespace underbrush::io
