/// \file
/// What the reader and the writer of log files share: names, comments and the rounding of rays.
/// Not part of the library's face; the layout itself is told in docs/reference/formats.md.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/io/ply_header.hpp"

namespace underbrush::io {

/// What our comments in a header say.
struct LogComments {
  bool ours = false;  ///< Whether the file is one of ours at all.
  LogInfo info;
  bool colours = false;  ///< red, green and blue are columns of the log, not a grey of ours.
  std::string provenance;
  std::map<std::string, ValueType> narrow;  ///< Columns stored wider than they are in memory.
};

/// The header's lines of comment for a log, each ending in a newline. `has_misses` and `colours`
/// are written with a fixed width, so that the text can be written again in place once they are
/// known.
std::string text_from_comments(const LogComments& comments);
/// The reverse; throws `FormatError` where a comment of ours is damaged.
LogComments comments_from_header(const std::string& file, const PlyHeader& header);

/// A column's name in the file: characters that would make CSIRO's reader, or ours, take the column
/// for another one are written as %XX.
std::string stored_name(const std::string& name);
/// The reverse.
std::string name_from_stored(const std::string& stored);
/// Whether a property of that name is one of the fixed columns of our files.
bool is_fixed_column(const std::string& name);

/// Rounds to a multiple of 1/`scale`, a power of two; |x|·scale < 2⁵¹.
inline double rounded(double x, double scale) {
  constexpr double kShift = 0x1.8p52;
  return ((x * scale + kShift) - kShift) / scale;
}

inline constexpr double kOriginScale = 0x1p24;    ///< Origins lie on a grid of 2⁻²⁴ m = 60 nm.
inline constexpr double kMaxCoordinate = 0x1p26;  ///< m; beyond, the grid does not fit.

/// 2ᵏ for the k with 2ᵏ <= x < 2ᵏ⁺¹; x > 0, normal.
inline double power_below(double x) {
  return std::bit_cast<double>(std::bit_cast<uint64_t>(x) & 0x7ff0000000000000ull);
}

/// The vector from end to origin as it is stored: −r d on a grid of 2⁻²¹ of r's power of two (but
/// at least 2⁻²⁴ m), 0.25 µm at 1 m and 16 µm at 100 m at most. Direction and range as floats,
/// computed back from it, are nearer than half a step, so that writing them again gives the same
/// vector; and end and origin stay on the origins' grid, where sums are exact.
inline Vec3 stored_ray(const Vec3f& direction, double range_m) {
  double power = power_below(range_m);
  while (true) {
    const double scale = std::min(kOriginScale, 0x1p21 / power);
    Vec3 ray(rounded(-range_m * double(direction.x()), scale),
             rounded(-range_m * double(direction.y()), scale),
             rounded(-range_m * double(direction.z()), scale));
    if (!(float(ray.norm()) >= 2 * power)) return ray;
    power *= 2;  // rounded across the power of two: the coarser grid, that of the stored length
  }
}

}  // namespace underbrush::io
