/// \file
/// The order of the columns of a pose file, as given in the line above them.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

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

/// Whether a line has as many names as there are columns, and x, y and z among them.
bool names_positions(std::string_view line, size_t columns);

}  // namespace underbrush::io
