#include "underbrush/io/geotiff.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/io/tiff_piece.hpp"

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
  kStripBytes = 279,
  kPredictor = 317,
  kTileWidth = 322,
  kTileHeight = 323,
  kTileOffsets = 324,
  kTileBytes = 325,
  kSampleFormat = 339,
  kPixelScale = 33550,
  kTiePoint = 33922,
  kTransform = 34264,
  kGeoKeys = 34735,
  kNoData = 42113,
};

/// Returns a number of a file as a code, which is a small whole number; −1 for others.
int code_of(double value) { return std::abs(value) < 1e9 ? int(value) : -1; }

/// Returns a number of a file as a count, 2⁵³ at most.
uint64_t count_of(double value) { return value >= 1 ? uint64_t(std::min(value, 0x1p53)) : 0; }

/// The first directory of a TIFF file.
class Tiff {
 public:
  Tiff(std::string file, std::string bytes) : file_(std::move(file)), bytes_(std::move(bytes)) {
    swap_ = bytes_.compare(0, 4, "MM\0*", 4) == 0;
    if (!swap_ && bytes_.compare(0, 4, "II*\0", 4) != 0) {
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
  /// The same as a code, which is a small whole number; −1 for others.
  int code(Tag tag, int otherwise) const { return code_of(number(tag, otherwise)); }
  bool big_endian() const { return swap_; }
  /// The bytes from `at` on, at most `most` of them.
  std::string_view bytes(uint64_t at, uint64_t most) const {
    if (at > bytes_.size()) {
      fail("byte " + std::to_string(at), "the file ends before it, truncated");
    }
    return std::string_view(bytes_).substr(at, most);
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

double sample(const char* at, int format, int bits, bool swap) {
  if (format == 3) return bits == 32 ? double(load<float>(at, swap)) : load<double>(at, swap);
  const bool is_signed = format == 2;
  if (bits == 8) return is_signed ? load<int8_t>(at, swap) : load<uint8_t>(at, swap);
  if (bits == 16) return is_signed ? load<int16_t>(at, swap) : load<uint16_t>(at, swap);
  return is_signed ? double(load<int32_t>(at, swap)) : double(load<uint32_t>(at, swap));
}

void check_kind(const Tiff& tiff, int format, int bits) {
  const bool known = format == 3
                         ? bits == 32 || bits == 64
                         : (format == 1 || format == 2) && (bits == 8 || bits == 16 || bits == 32);
  const std::string unread = unread_compression(tiff.code(kCompression, 1));
  if (!unread.empty()) tiff.fail("", "is compressed by " + unread + kConvert);
  const double predictor = tiff.number(kPredictor, 1);
  if (predictor != 1 && predictor != 2 && !(predictor == 3 && format == 3)) {
    tiff.fail("", std::string("has an unusual predictor") + kConvert);
  }
  if (tiff.number(kSamples, 1) != 1) tiff.fail("", std::string("has several bands") + kConvert);
  if (!known) tiff.fail("", std::string("has values of an unusual type") + kConvert);
  if (tiff.has(kTransform) || tiff.numbers(kPixelScale).size() < 2 ||
      tiff.numbers(kTiePoint).size() < 6) {
    tiff.fail("", std::string("has no place on a map, or is turned") + kConvert);
  }
}

/// Returns the value of a key of GeoTIFF that is a whole number; 0 where there is none.
int geo_key(const Tiff& tiff, int key) {
  const std::vector<double> keys = tiff.numbers(kGeoKeys);
  for (size_t k = 4; k + 3 < keys.size(); k += 4) {
    if (keys[k] == key && keys[k + 1] == 0) return code_of(keys[k + 3]);
  }
  return 0;
}

/// Refuses a map whose place is in degrees, and names the system of UTM there.
[[noreturn]] void fail_in_degrees(const Tiff& tiff, double east, double north) {
  std::string system = "EPSG:NUMBER";
  if (std::abs(east) <= 180 && std::abs(north) <= 90) {
    const int zone = std::min(60, int(std::floor((east + 180) / 6)) + 1);
    system = "EPSG:" + std::to_string((north < 0 ? 32700 : 32600) + zone);
  }
  tiff.fail("", "its map is in degrees; 'gdalwarp -t_srs " + system +
                    " IN.tif OUT.tif' makes one in metres");
}

/// Sets the place of the raster's corner, the side of its cells and the unit of both.
void place(const Tiff& tiff, Raster& raster) {
  const std::vector<double> scale = tiff.numbers(kPixelScale), tie = tiff.numbers(kTiePoint);
  constexpr int kModelType = 1024, kGeographic = 2, kGeocentric = 3;
  const int model = geo_key(tiff, kModelType);
  if (model == kGeographic) fail_in_degrees(tiff, tie[3], tie[4]);
  if (model == kGeocentric) tiff.fail("", std::string("its coordinates are geocentric") + kConvert);
  if (!(scale[0] > 0) || !(std::abs(scale[0] - scale[1]) < 1e-6 * scale[0])) {
    tiff.fail("", std::string("its cells are not square") + kConvert);
  }
  constexpr int kRasterType = 1025, kPoint = 2;
  // The tie point may be the middle of a cell.
  const double shift = geo_key(tiff, kRasterType) == kPoint ? 0.5 : 0;
  constexpr int kLinearUnit = 3076, kFoot = 9002, kSurveyFoot = 9003;
  constexpr int kHeightUnit = 4099;
  const auto unit_of = [&](int key, double otherwise) {
    const int unit = geo_key(tiff, key);
    return unit == 0 ? otherwise : unit == kFoot ? 0.3048 : unit == kSurveyFoot ? 1200.0 / 3937 : 1;
  };
  raster.unit_m = unit_of(kLinearUnit, 1);
  if (std::abs(unit_of(kHeightUnit, raster.unit_m) - raster.unit_m) > 0.1) {
    tiff.fail("", "its heights and its map have different units, m and feet: bring both to m");
  }
  raster.cell_m = scale[0];
  raster.west = tie[3] - (tie[0] + shift) * scale[0];
  raster.north = tie[4] + (tie[1] + shift) * scale[0];
}

/// Returns the value that the file gives for "no data"; NaN where it gives none.
double no_data(const Tiff& tiff) {
  std::string text;
  for (const double c : tiff.numbers(kNoData)) {
    if (c > 32 && c < 127) text += char(c);
  }
  return number_of(text).value_or(NAN);
}

/// Makes NaN of the cells without a height and counts them. Values for "no data" are often written
/// with fewer digits than they have, or not named at all.
void leave_out(double nothing, const std::string& name, Raster& map,
               std::map<std::string, size_t>& left_out) {
  constexpr float kMostHeight = 32766, kUsual = -9999;  // m; the usual value for "no data"
  size_t named = 0, unnamed = 0;
  double example = 0;
  for (float& value : map.value) {
    if (std::isnan(value) || value == float(nothing) ||
        (std::abs(value) > kMostHeight && std::abs(nothing) > double(kMostHeight))) {
      ++named;
    } else if (std::abs(value) > kMostHeight || value == kUsual) {
      ++unnamed;
      example = double(value);
    } else {
      continue;
    }
    value = NAN;
  }
  const std::string cells = "cells of " + in_quotes(name) + " without a height";
  if (named > 0) left_out[cells] += named;
  if (unnamed == 0) return;
  char text[64];
  std::snprintf(text, sizeof text, "%.6g", example);
  left_out[cells + ", of values such as " + text + ", which it does not name as no data"] +=
      unnamed;
}

/// Where the strips or tiles of a file stand, and how they are stored.
struct Pieces {
  std::vector<double> offset, bytes;
  uint64_t across = 1, down = 1, in_row = 1;  ///< Cells of a piece; pieces side by side.
  bool tiled = false;
  TiffCoding coding;
};

Pieces pieces_of(const Tiff& tiff, const Raster& raster) {
  Pieces out;
  out.tiled = tiff.has(kTileOffsets);
  out.offset = tiff.numbers(out.tiled ? kTileOffsets : kStripOffsets);
  out.bytes = tiff.numbers(out.tiled ? kTileBytes : kStripBytes);
  out.across = out.tiled ? count_of(std::max(1.0, tiff.number(kTileWidth, 0))) : raster.columns;
  out.down = count_of(std::max(1.0, out.tiled ? tiff.number(kTileHeight, 0)
                                              : tiff.number(kRowsPerStrip, double(raster.rows))));
  if (!out.tiled) out.down = std::min<uint64_t>(out.down, raster.rows);
  out.in_row = (raster.columns + out.across - 1) / out.across;
  const uint64_t in_column = (raster.rows + out.down - 1) / out.down;
  if (out.offset.size() < out.in_row * in_column) tiff.fail("", "lacks a strip or tile");
  // A tile is padded to its size; a file whose tiles are much larger than it is a mistake or worse.
  if (double(out.across) * double(out.down) * double(out.in_row) * double(in_column) >
      4.0 * double(kMostCells)) {
    tiff.fail("", "has tiles that are much larger than its map");
  }
  out.coding = {tiff.code(kCompression, 1), tiff.code(kPredictor, 1), tiff.code(kBits, 1),
                size_t(out.across), tiff.big_endian()};
  return out;
}

/// Sets the cells of the piece of this number.
void read_piece(const Tiff& tiff, const Pieces& pieces, int format, uint64_t piece, Raster& out) {
  const uint64_t first_row = piece / pieces.in_row * pieces.down,
                 first_column = piece % pieces.in_row * pieces.across;
  const uint64_t rows = std::min<uint64_t>(pieces.down, out.rows - first_row),
                 columns = std::min<uint64_t>(pieces.across, out.columns - first_column);
  const auto width = uint64_t(pieces.coding.bits / 8);
  const uint64_t size = pieces.across * (pieces.tiled ? pieces.down : rows) * width;
  const bool plain = pieces.coding.compression == 1;
  const double stored = plain                         ? double(size)
                        : piece < pieces.bytes.size() ? pieces.bytes[piece]
                                                      : double(kMostBytes);
  const auto samples = decode_tiff_piece(
      tiff.bytes(count_of(pieces.offset[piece]), count_of(stored)), pieces.coding, size);
  if (!samples) {
    tiff.fail(std::string(pieces.tiled ? "tile " : "strip ") + std::to_string(piece),
              plain ? "the file ends before its last row, truncated" : "is damaged or truncated");
  }
  for (uint64_t r = 0; r < rows; ++r) {
    for (uint64_t c = 0; c < columns; ++c) {
      out.value[(first_row + r) * out.columns + first_column + c] =
          float(sample(samples->data() + (r * pieces.across + c) * width, format,
                       pieces.coding.bits, tiff.big_endian()));
    }
  }
}

/// Refuses a map without a word about its system where it must be in degrees: its heights vary by
/// more than all of its width.
void check_heights(const Tiff& tiff, const Raster& map) {
  constexpr int kModelType = 1024;
  constexpr double kSmall = 0.01;
  if (geo_key(tiff, kModelType) != 0 || map.cell_m > kSmall) return;
  float low = INFINITY, high = -INFINITY;
  for (const float z : map.value) {
    low = std::min(low, std::isnan(z) ? low : z);
    high = std::max(high, std::isnan(z) ? high : z);
  }
  if (double(high) - double(low) > map.cell_m * std::max(map.columns, map.rows)) {
    fail_in_degrees(tiff, map.west, map.north);
  }
}

}  // namespace

Raster read_geotiff(const std::filesystem::path& path, std::map<std::string, size_t>& left_out) {
  const Tiff tiff(path.string(), read_file(path, kMostBytes));
  const int format = tiff.code(kSampleFormat, 1), bits = tiff.code(kBits, 1);
  check_kind(tiff, format, bits);
  const double width = tiff.number(kWidth, 0), height = tiff.number(kHeight, 0);
  if (!(width >= 1 && height >= 1 && width * height <= double(kMostCells))) {
    tiff.fail("", "has no cells, or more than 67 million");
  }
  Raster out;
  out.columns = uint32_t(width);
  out.rows = uint32_t(height);
  place(tiff, out);
  const Pieces pieces = pieces_of(tiff, out);
  out.value.resize(size_t(out.columns) * out.rows);
  const uint64_t in_column = (out.rows + pieces.down - 1) / pieces.down;
  for (uint64_t piece = 0; piece < pieces.in_row * in_column; ++piece) {
    read_piece(tiff, pieces, format, piece, out);
  }
  leave_out(no_data(tiff), path.filename().string(), out, left_out);
  check_heights(tiff, out);
  return out;
}

}  // namespace underbrush::io
