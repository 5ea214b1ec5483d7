/// \file
/// The ways on which platforms of HELIOS++ carry their scanner.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::worlds {

/// A time (s) before or after all others.
inline constexpr double kEver = 1e12;

/// The settings of a leg, with the defaults of HELIOS++.
struct LegSettings {
  Vec3 position = Vec3::Zero();
  bool on_ground = false, active = true;
  double speed_m_per_s = 70;
  double pulse_hz = 0, scan_hz = 0, scan_rad = 0;
  double low_rad = std::numeric_limits<double>::quiet_NaN(), high_rad = low_rad;
  double head_rad_per_s = 0, head_start_rad = 0, head_stop_rad = 0;
  double vertical_step_rad = 0, horizontal_step_rad = 0;
  double longest_s = -1;  ///< Not positive = no limit.
  double warmup_s = 0;    ///< Time for which head and optics turn before the first pulse.

  double warmup_pulses() const {
    return std::isfinite(pulse_hz) ? std::max(0.0, std::round(warmup_s * pulse_hz)) : 0;
  }
};

/// The mounting of the scanner on the platform. As in HELIOS++, the position does not turn with the
/// platform.
struct ScannerMount {
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 head_axis = Vec3::UnitZ();
};

/// The turn of the scanner's head.
struct HeadTurn {
  double start_rad = 0, stop_rad = 0, speed_rad_per_s = 0, pulse_hz = 1;
};

/// Poses of the scanner's head (world from sensor, our axes); empty where there is no duration.
struct LegPath {
  std::vector<StampedPose> poses;
};

/// A file of a trajectory and its columns: time, roll, pitch, yaw, x, y, z. Where the survey gives
/// no columns, a line `#HEADER: "t", "roll", …` of the file does.
struct TrajectoryFile {
  std::filesystem::path path;
  std::array<size_t, 7> columns{0, 1, 2, 3, 4, 5, 6};
  bool columns_given = true;
  bool degrees = true;     ///< Angles are degrees, which HELIOS++ turns to radians.
  bool canonical = false;  ///< Rotations about x, y, z; else those of ARINC 705.
};

/// A platform that stands: the head turns from start to stop, or stands for `longest_s`.
LegPath standing(const Vec3& at, const ScannerMount& mount, const HeadTurn& head, double start_s,
                 double longest_s);
/// A platform that moves straight, at one speed and with its y axis forward, at most `longest_s`
/// (if positive).
LegPath flying(const Vec3& from, const Vec3& to, double speed_m_per_s, const ScannerMount& mount,
               const HeadTurn& head, double start_s, double longest_s);
/// A platform that follows the poses of a file between two times, at most `longest_s` (if
/// positive). Of equal poses at one time one is kept; of others the later one follows 1 µs after.
/// Throws `FormatError`.
LegPath along_file(const TrajectoryFile& file, double from_s, double to_s, double longest_s,
                   const ScannerMount& mount, const HeadTurn& head);

}  // namespace underbrush::worlds
