#include "underbrush/io/raster_file.hpp"

#include <bit>
#include <cstring>
#include <string>

#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::io {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void append(std::string& to, T value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The directory of a TIFF file, whose entries must be added in rising order of their tags.
class Directory {
 public:
  explicit Directory(uint32_t offset) : values_at_(offset) {}
  void add(uint16_t tag, uint16_t type, uint32_t count, std::string bytes) {
    append(entries_, tag);
    append(entries_, type);
    append(entries_, count);
    ++count_;
    if (bytes.size() <= 4) {
      bytes.resize(4, '\0');
      entries_ += bytes;
      return;
    }
    if (values_.size() % 2) values_.push_back('\0');
    append(entries_, uint32_t(values_at_ + values_.size()));
    values_ += bytes;
  }
  void number(uint16_t tag, uint32_t value) {
    std::string bytes;
    append(bytes, value);
    add(tag, 4, 1, bytes);
  }
  template <class T>
  void list(uint16_t tag, uint16_t type, const std::vector<T>& values) {
    std::string bytes;
    for (const T v : values) append(bytes, v);
    add(tag, type, uint32_t(values.size()), bytes);
  }
  std::string values() const { return values_; }
  std::string bytes() const {
    std::string out;
    append(out, count_);
    out += entries_;
    append(out, uint32_t(0));  // There is no further directory.
    return out;
  }

 private:
  uint32_t values_at_;
  uint16_t count_ = 0;
  std::string entries_, values_;
};

constexpr uint16_t kShort = 3, kDouble = 12, kText = 2;

}  // namespace

void write_geotiff(const std::filesystem::path& path, const Raster& r) {
  require(r.columns > 0 && r.rows > 0 && r.value.size() == size_t(r.columns) * r.rows,
          "raster: needs a value for each of its cells");
  require(r.value.size() < (uint64_t(1) << 29), "raster: too many cells for TIFF");
  const auto data_bytes = uint32_t(r.value.size() * sizeof(float));
  constexpr uint32_t kHeader = 8;
  Directory d(kHeader + data_bytes);
  d.number(256, r.columns);
  d.number(257, r.rows);
  d.list<uint16_t>(258, kShort, {32});
  d.list<uint16_t>(259, kShort, {1});  // no compression
  d.list<uint16_t>(262, kShort, {1});  // black is zero
  d.number(273, kHeader);
  d.list<uint16_t>(277, kShort, {1});
  d.number(278, r.rows);
  d.number(279, data_bytes);
  d.list<uint16_t>(339, kShort, {3});  // floating point
  d.list<double>(33550, kDouble, {r.cell_m, r.cell_m, 0});
  d.list<double>(33922, kDouble, {0, 0, 0, r.west, r.north, 0});
  std::vector<uint16_t> keys{1, 1, 1, 1, 1025, 0, 1, 1};  // A pixel is an area.
  if (r.epsg) {
    keys = {1, 1, 1, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, r.epsg};
  }
  d.list<uint16_t>(34735, kShort, keys);
  d.add(42113, kText, 4, std::string("nan\0", 4));
  std::string bytes = "II";
  append(bytes, uint16_t(42));
  const std::string values = d.values();
  const auto pad = uint32_t(values.size() % 2);
  append(bytes, uint32_t(kHeader + data_bytes + values.size() + pad));
  bytes.append(reinterpret_cast<const char*>(r.value.data()), data_bytes);
  bytes += values + std::string(pad, '\0') + d.bytes();
  write_atomically(path, bytes);
}

void write_npy(const std::filesystem::path& path, const std::vector<size_t>& shape,
               const std::vector<float>& value) {
  size_t n = 1;
  std::string text = "{'descr': '<f4', 'fortran_order': False, 'shape': (";
  for (const size_t side : shape) {
    n *= side;
    text += std::to_string(side) + ", ";
  }
  require(n == value.size() && !shape.empty(), "npy: the shape does not fit the values");
  text += "), }";
  constexpr size_t kBefore = 10, kAlignment = 64;
  text += std::string(kAlignment - (kBefore + text.size() + 1) % kAlignment, ' ') + "\n";
  std::string bytes("\x93NUMPY\x01\x00", 8);
  append(bytes, uint16_t(text.size()));
  bytes += text;
  bytes.append(reinterpret_cast<const char*>(value.data()), value.size() * sizeof(float));
  write_atomically(path, bytes);
}

}  // namespace underbrush::io
