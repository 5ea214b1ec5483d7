#include "underbrush/io/geotiff.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

constexpr uint64_t kMostBytes = uint64_t(1) << 32, kMostCells = uint64_t(1) << 26;
constexpr size_t kEntry = 12;  // bytes

enum Tag : uint16_t {
  kWidth = 256,
  kHeight = 257,
  kBits = 258,
  kCompression = 259,
  kStripOffsets = 273,
  kSamples = 277,
  kRowsPerStrip = 278,
  kTileWidth = 322,
  kTileHeight = 323,
  kTileOffsets = 324,
  kSampleFormat = 339,
  kPixelScale = 33550,
  kTiePoint = 33922,
  kTransform = 34264,
  kGeoKeys = 34735,
  kNoData = 42113,
};

/// The first directory of a TIFF file.
class Tiff {
 public:
  Tiff(std::string file, std::string bytes) : file_(std::move(file)), bytes_(std::move(bytes)) {
    const std::string_view magic = std::string_view(bytes_).substr(0, 4);
    swap_ = magic == std::string_view("MM\0*", 4);
    if (!swap_ && magic != std::string_view("II*\0", 4)) {
      fail("", "is not a TIFF file, or a BigTIFF");
    }
    const uint64_t at = whole<uint32_t>(4);
    const size_t entries = whole<uint16_t>(at);
    for (size_t k = 0; k < entries; ++k) {
      const uint64_t entry = at + 2 + kEntry * k;
      entries_[whole<uint16_t>(entry)] = entry;
    }
  }

  [[noreturn]] void fail(const std::string& place, const std::string& reason) const {
    throw FormatError(file_, place, reason);
  }
  bool has(Tag tag) const { return entries_.count(tag) > 0; }

  /// The numbers of a tag; empty where there is none.
  std::vector<double> numbers(Tag tag) const {
    std::vector<double> out;
    const auto found = entries_.find(tag);
    if (found == entries_.end()) return out;
    const uint16_t type = whole<uint16_t>(found->second + 2);
    const uint64_t count = whole<uint32_t>(found->second + 4);
    const size_t size = type == 3 ? 2 : type == 4 ? 4 : type == 12 ? 8 : 1;
    const bool inside = count * size <= 4;
    const uint64_t at = inside ? found->second + 8 : whole<uint32_t>(found->second + 8);
    if (count * size > bytes_.size()) fail("tag " + std::to_string(tag), "truncated");
    for (uint64_t k = 0; k < count; ++k) {
      out.push_back(size == 2   ? double(whole<uint16_t>(at + 2 * k))
                    : size == 4 ? double(whole<uint32_t>(at + 4 * k))
                    : size == 8 ? whole<double>(at + 8 * k)
                                : double(whole<uint8_t>(at + k)));
    }
    return out;
  }
  double number(Tag tag, double otherwise) const {
    const std::vector<double> found = numbers(tag);
    return found.empty() ? otherwise : found[0];
  }
  template <class T>
  T whole(uint64_t at) const {
    if (at > bytes_.size() || bytes_.size() - at < sizeof(T)) {
      fail("byte " + std::to_string(at), "the file ends before it, truncated");
    }
    return load<T>(bytes_.data() + at, swap_);
  }

 private:
  std::string file_, bytes_;
  bool swap_ = false;
  std::map<uint16_t, uint64_t> entries_;
};

constexpr const char* kConvert =
    "; 'gdalwarp -ot Float32 -co COMPRESS=NONE IN.tif OUT.tif' makes one that is read";

double sample(const Tiff& tiff, int format, int bits, uint64_t at) {
  if (format == 3) return bits == 32 ? double(tiff.whole<float>(at)) : tiff.whole<double>(at);
  const bool is_signed = format == 2;
  if (bits == 8) return is_signed ? tiff.whole<int8_t>(at) : tiff.whole<uint8_t>(at);
  if (bits == 16) return is_signed ? tiff.whole<int16_t>(at) : tiff.whole<uint16_t>(at);
  return is_signed ? double(tiff.whole<int32_t>(at)) : double(tiff.whole<uint32_t>(at));
}

void check_kind(const Tiff& tiff, int format, int bits) {
  const bool known = format == 3
                         ? bits == 32 || bits == 64
                         : (format == 1 || format == 2) && (bits == 8 || bits == 16 || bits == 32);
  if (tiff.number(kCompression, 1) != 1) tiff.fail("", std::string("is compressed") + kConvert);
  if (tiff.number(kSamples, 1) != 1) tiff.fail("", std::string("has several bands") + kConvert);
  if (!known) tiff.fail("", std::string("has values of an unusual type") + kConvert);
  if (tiff.has(kTransform) || tiff.numbers(kPixelScale).size() < 2 ||
      tiff.numbers(kTiePoint).size() < 6) {
    tiff.fail("", std::string("has no place on a map, or is turned") + kConvert);
  }
}

/// Sets the place of the raster's corner and the side of its cells.
void place(const Tiff& tiff, Raster& raster) {
  const std::vector<double> scale = tiff.numbers(kPixelScale), tie = tiff.numbers(kTiePoint),
                            keys = tiff.numbers(kGeoKeys);
  if (!(scale[0] > 0) || !(std::abs(scale[0] - scale[1]) < 1e-6 * scale[0])) {
    tiff.fail("", std::string("its cells are not square") + kConvert);
  }
  constexpr double kRasterType = 1025, kPoint = 2;
  double shift = 0;  // The tie point may be the middle of a cell.
  for (size_t k = 4; k + 3 < keys.size(); k += 4) {
    if (keys[k] == kRasterType && keys[k + 3] == kPoint) shift = 0.5;
  }
  raster.cell_m = scale[0];
  raster.west = tie[3] - (tie[0] + shift) * scale[0];
  raster.north = tie[4] + (tie[1] + shift) * scale[0];
}

double no_data(const Tiff& tiff) {
  std::string text;
  for (const double c : tiff.numbers(kNoData)) {
    if (c > 32) text += char(c);
  }
  return number_of(text).value_or(NAN);
}

}  // namespace

Raster read_geotiff(const std::filesystem::path& path) {
  const Tiff tiff(path.string(), read_file(path, kMostBytes));
  const int format = int(tiff.number(kSampleFormat, 1)), bits = int(tiff.number(kBits, 1));
  check_kind(tiff, format, bits);
  const double width = tiff.number(kWidth, 0), height = tiff.number(kHeight, 0);
  if (!(width >= 1 && height >= 1 && width * height <= double(kMostCells))) {
    tiff.fail("", "has no cells, or more than 67 million");
  }
  Raster out;
  out.columns = uint32_t(width);
  out.rows = uint32_t(height);
  place(tiff, out);
  const bool tiled = tiff.has(kTileOffsets);
  const std::vector<double> offset = tiff.numbers(tiled ? kTileOffsets : kStripOffsets);
  const auto across = uint64_t(tiled ? std::max(1.0, tiff.number(kTileWidth, 0)) : width);
  const auto down = uint64_t(
      std::max(1.0, tiled ? tiff.number(kTileHeight, 0) : tiff.number(kRowsPerStrip, height)));
  const uint64_t pieces = (out.columns + across - 1) / across;
  const double nothing = no_data(tiff);
  out.value.resize(size_t(out.columns) * out.rows);
  for (uint64_t r = 0; r < out.rows; ++r) {
    for (uint64_t c = 0; c < out.columns; ++c) {
      const uint64_t piece = r / down * pieces + c / across;
      if (piece >= offset.size()) tiff.fail("", "lacks a strip or tile");
      const uint64_t at =
          uint64_t(offset[piece]) + (r % down * across + c % across) * uint64_t(bits / 8);
      const double value = sample(tiff, format, bits, at);
      out.value[r * out.columns + c] = value == nothing ? NAN : float(value);
    }
  }
  return out;
}

}  // namespace underbrush::io
