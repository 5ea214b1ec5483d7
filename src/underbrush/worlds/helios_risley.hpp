/// \file
/// The prisms of scanners of HELIOS++ whose optics are `risley`.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/worlds/xml_file.hpp"

namespace underbrush::worlds {

/// An emitter of a scanner, which fires at every pulse.
struct Emitter {
  /// Attitude on the scanner's head, in the frame of HELIOS++.
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
  pugi::xml_node channel;  ///< Its element; none for a scanner without channels.
};

/// Returns the lines of a sensor file that describe the pattern of a scanner: its prisms and
/// lasers. `turned_s` is the time for which the prisms have turned before the first pulse. Throws
/// `FormatError` where the scanner states no prisms, as those of HELIOS++ before 2.1 do.
std::string risley_pattern(const XmlFile& file, const pugi::xml_node& scanner,
                           const std::vector<Emitter>& emitters, double pulse_hz, double turned_s);

}  // namespace underbrush::worlds
