#include "underbrush/worlds/helios_risley.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace underbrush::worlds {
namespace {

/// Returns the prisms of an emitter, whose channel may have other values than the scanner. At time
/// 0 their positions and their senses of rotation are those of our sensor files.
std::string prisms_of(const XmlFile& file, const pugi::xml_node& scanner, const Emitter& emitter) {
  const auto value = [&](const std::string& name, double otherwise) {
    const double own = file.number(scanner, name.c_str(), otherwise);
    return file.number(emitter.channel, name.c_str(), own);
  };
  std::ostringstream rotors, angles, indices;
  for (std::ostringstream* column : {&rotors, &angles, &indices}) column->precision(17);
  const double air = value("refrIndex_air", 1);
  const char* comma = "";
  for (const std::string& n : {std::string("1"), std::string("2"), std::string("3")}) {
    const double angle_deg = value("angle" + n + "_deg", 0);
    if (std::abs(angle_deg) <= 1e-6) continue;  // HELIOS++ has no such prism.
    rotors << comma << value("rotorFreq" + n + "_Hz", 0);
    angles << comma << angle_deg;
    const double index = value("refrIndex" + n, 1) / air;
    if (!(index >= 0.1 && index <= 10)) file.fail(scanner, "refrIndex" + n + ": not 0.1 to 10");
    indices << comma << index;
    comma = ", ";
  }
  if (*comma == 0) {
    file.fail(scanner, "optics: no angle1_deg, which scanners with prisms have since HELIOS++ 2.1");
  }
  return "{rotor_hz: [" + rotors.str() + "], angle_deg: [" + angles.str() + "], index: [" +
         indices.str() + "]}";
}

}  // namespace

std::string risley_pattern(const XmlFile& file, const pugi::xml_node& scanner,
                           const std::vector<Emitter>& emitters, double pulse_hz, double turned_s) {
  // HELIOS++ turns the prisms by the time of a pulse before it fires.
  const Eigen::Quaterniond ours(Eigen::AngleAxisd(-M_PI / 2, Vec3::UnitZ()));
  const std::string all = prisms_of(file, scanner, {});
  std::ostringstream y;
  y.precision(17);
  y << "kind: risley\nrate_hz: " << std::min(10.0, pulse_hz) << "\nshots_per_s: " << pulse_hz
    << "\nstart_s: " << turned_s + 1 / pulse_hz << "\nprisms: " << all << "\nlasers:";
  for (const Emitter& e : emitters) {
    const pugi::xml_node incident = e.channel.child("incidentBeam");
    const Vec3 d = ours * (incident ? file.vector(incident) : Vec3::UnitY());
    const Eigen::Quaterniond q = ours * e.attitude * ours.conjugate();
    y << "\n  - {direction: [" << d.x() << ", " << d.y() << ", " << d.z() << "], attitude: ["
      << q.x() << ", " << q.y() << ", " << q.z() << ", " << q.w() << "]";
    const std::string own = prisms_of(file, scanner, e);
    y << (own == all ? "}" : ", prisms: " + own + "}");
  }
  return y.str() + "\n";
}

}  // namespace underbrush::worlds
