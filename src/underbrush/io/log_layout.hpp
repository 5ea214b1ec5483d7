/// \file
/// The parts that the reader and the writer of log files share: names of columns, comments in the
/// header, and the rounding of rays. It is internal to the module; the layout is described in
/// docs/reference/formats.md.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/io/ply_header.hpp"

namespace underbrush::io {

/// The contents of Underbrush's own comments in a log's header.
struct LogComments {
  bool ours = false;  ///< Whether Underbrush wrote the file.
  LogInfo info;
  bool pad_range = false;  ///< Whether the maximum range has a fixed width, for overwriting.
  bool colours = false;    ///< Whether red, green and blue are columns of the log, not a grey
                           ///< derived from the intensity.
  std::string provenance;
  /// Columns that are stored in a wider type than they have in memory.
  std::map<std::string, ValueType> narrow;
};

/// Writes the header's comment lines for a log, each ending in a newline. `has_misses` and
/// `colours` have a fixed width, so that the text can be overwritten in place once they are known.
std::string text_from_comments(const LogComments& comments);
/// Parses the comments of a header. Throws `FormatError` where one of Underbrush's own is damaged.
LogComments comments_from_header(const std::string& file, const PlyHeader& header);

/// Returns the name of a column as the file stores it. Characters that would make a reader
/// (CSIRO's, or this one) mistake the column for another are written as %XX.
std::string stored_name(const std::string& name);
/// Returns the name of the column that the file stores as `stored`.
std::string name_from_stored(const std::string& stored);
/// Whether `name` is one of the fixed columns of a log file.
bool is_fixed_column(const std::string& name);

/// Rounds to a multiple of 1/`scale`, a power of two; |x|·scale < 2⁵¹.
inline double rounded(double x, double scale) {
  constexpr double kShift = 0x1.8p52;
  return ((x * scale + kShift) - kShift) / scale;
}

inline constexpr double kOriginScale = 0x1p24;  ///< Origins lie on a grid of 2⁻²⁴ m = 60 nm.
inline constexpr double kMinRange =
    kLeastRangeM;  ///< m; shorter rays have no direction on the grid.

/// Returns 2ᵏ for the k with 2ᵏ <= x < 2ᵏ⁺¹; x > 0 and normal.
inline double power_below(double x) {
  return std::bit_cast<double>(std::bit_cast<uint64_t>(x) & 0x7ff0000000000000ull);
}

/// Returns the vector from the end point to the origin as it is stored: −r d, rounded to a grid of
/// 2⁻²¹ of r's power of two (but at least 2⁻²⁴ m), which is 0.25 µm at 1 m and at most 16 µm at 100
/// m. The direction and range (float) computed back from it are exact to less than half a step, so
/// that writing them again gives the same vector. End point and origin stay on the grid of the
/// origins, where sums are exact.
inline Vec3 stored_ray(const Vec3f& direction, double range_m) {
  double power = power_below(range_m);
  while (true) {
    const double scale = std::min(kOriginScale, 0x1p21 / power);
    Vec3 ray(rounded(-range_m * double(direction.x()), scale),
             rounded(-range_m * double(direction.y()), scale),
             rounded(-range_m * double(direction.z()), scale));
    if (!(float(ray.norm()) >= 2 * power)) return ray;
    power *= 2;  // Rounding crossed a power of two: the stored length demands the coarser grid.
  }
}

}  // namespace underbrush::io
