/// \file
/// The order of the columns of a pose file, as given in the line above them.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace underbrush::io {

/// Columns of time, position x y z, and quaternion x y z w.
using PoseColumns = std::array<size_t, 8>;

/// Finds the columns of poses with quaternions in a line of names, such as "#timestamp, p_RS_R_x
/// [m], …, q_RS_w []" (EuRoC, TUM-VI) or "# t tx ty tz qw qx qy qz". Returns nothing where the line
/// does not name all eight once.
std::optional<PoseColumns> pose_columns_of(std::string_view line);

}  // namespace underbrush::io
