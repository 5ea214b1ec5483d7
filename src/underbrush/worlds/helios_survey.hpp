/// \file
/// Surveys of HELIOS++: the scanner of each leg as a sensor file, and its path as a trajectory.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::worlds {

/// A function for the height (m) of the ground below a place; nothing where there is none.
using HeightAt = std::function<std::optional<double>(double x, double y)>;

/// A leg of a survey on which the scanner measures.
struct SurveyLeg {
  size_t number = 0;       ///< The place of its element leg in the survey, from 0.
  std::string sensor;      ///< A sensor file (YAML) of the kind `directions` or `risley`.
  std::string directions;  ///< Its table (CSV), which the sensor file calls `table_name`.
  std::string table_name;  ///< Empty for a scanner with prisms, whose sensor file has no table.
  Trajectory trajectory;   ///< World from sensor; the turn of the scanner's head is in it.
};

/// A survey.
struct Survey {
  std::filesystem::path file;  ///< The XML file that it was read from.
  std::string name;
  std::vector<SurveyLeg> legs;
  /// Number of things in the XML that are not used, by kind.
  std::map<std::string, size_t> left_out;
};

/// Reads the legs of the survey in an XML file, with its platform and scanner. `ground_at` gives
/// the height (m) below a place for legs on the ground; it may be empty. docs/how-to/helios.md
/// lists the data that are read. Throws `FormatError`, also for a scanner whose optics are not
/// oscillating, conic, line, rotating or risley.
Survey read_helios_survey(const std::filesystem::path& path, const HeightAt& ground_at,
                          const std::filesystem::path& assets = {});

/// The angle of the beam (rad) at each pulse of a line of a deflector of HELIOS++, about the axis
/// to the right; NaN for a pulse that does not leave the scanner.
struct Deflector {
  std::string optics;  ///< oscillating, conic, line or rotating.
  double pulse_hz = 0, scan_hz = 0;
  double scan_rad = 0;               ///< Half of the scan angle.
  double scan_max_rad = 0;           ///< Half of the device's scan angle; for rotating optics.
  double low_rad = 0, high_rad = 0;  ///< Angles between which a pulse leaves; for rotating optics.
  size_t fibres = 1;                 ///< For optics of a line.
};
/// Returns the unit vectors of the pulses of a line, in the frame of the scanner: x right, y
/// forward, z up. A pulse that does not leave the scanner is a zero vector.
std::vector<Vec3> line_of(const Deflector& deflector);

}  // namespace underbrush::worlds
