/// \file
/// The order of the columns of a pose file, as given in the line above them.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "underbrush/io/text.hpp"

namespace underbrush::io {

/// Columns of time, position x y z, and quaternion x y z w.
using PoseColumns = std::array<size_t, 8>;

/// Finds the columns of poses with quaternions in a line of names, such as "#timestamp, p_RS_R_x
/// [m], …, q_RS_w []" (EuRoC, TUM-VI), "# t tx ty tz qw qx qy qz", or "t,x,y,z,qr,qi,qj,qk".
/// Returns nothing where the line does not name all eight once.
std::optional<PoseColumns> pose_columns_of(std::string_view line);

/// The column of a line of names that counts the parts of a second besides one of whole seconds, as
/// in "sec,nsec,x,y,…", and its unit, s.
std::optional<std::pair<size_t, double>> seconds_part_of(std::string_view line);

/// Turns rows below a header that names time, place, roll, pitch and yaw, as in
/// "GPSTime,Easting,Northing,Height,Roll,Pitch,Yaw", to rows of t x y z qx qy qz qw: turns about x,
/// then y, then z. The header has "rad" or "deg"; angles beyond a revolution in radians are
/// degrees. Returns what was assumed, and "" where there is no such header. Throws `FormatError`
/// with the file's name where the unit is not known.
std::string use_angles(const std::string& file, NumberRows& numbers);

/// Whether a line has as many names as there are columns, and x, y and z among them.
bool names_positions(std::string_view line, size_t columns);

}  // namespace underbrush::io
