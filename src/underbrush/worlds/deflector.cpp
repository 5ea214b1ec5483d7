#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/worlds/helios_survey.hpp"

namespace underbrush::worlds {
namespace {

Vec3 up_by(double angle_rad) { return {0, std::cos(angle_rad), std::sin(angle_rad)}; }

/// From −θ to θ and back at one speed.
void oscillate(const Deflector& d, std::vector<Vec3>& line) {
  const double half = 0.5 * double(line.size());
  for (size_t k = 0; k < line.size(); ++k) {
    const double phase = double(k) / half;
    line[k] = up_by(d.scan_rad * (phase <= 1 ? 2 * phase - 1 : 3 - 2 * phase));
  }
}

void turn(const Deflector& d, std::vector<Vec3>& line) {
  const double step = 2 * d.scan_max_rad * d.scan_hz / d.pulse_hz;
  for (size_t k = 0; k < line.size(); ++k) {
    const double angle = -d.scan_max_rad + step * double(k);
    const bool leaves = angle > d.low_rad && angle <= d.high_rad;
    line[k] = leaves ? up_by(angle) : Vec3::Zero();
  }
}

void circle(const Deflector& d, std::vector<Vec3>& line) {
  for (size_t k = 0; k < line.size(); ++k) {
    const double b = 2 * M_PI * double(k) / double(line.size());
    line[k] = {std::sin(d.scan_rad) * std::sin(b), std::cos(d.scan_rad),
               std::sin(d.scan_rad) * std::cos(b)};
  }
}

}  // namespace

std::vector<Vec3> line_of(const Deflector& d) {
  constexpr double kMostPulses = 1e6;
  if (d.optics == "line") {
    std::vector<Vec3> line(d.fibres);
    const double step = 2 * d.scan_rad / double(d.fibres);
    for (size_t k = 0; k < d.fibres; ++k) line[k] = up_by(-d.scan_rad + step * double(k));
    return line;
  }
  const double pulses = d.scan_hz > 0 ? std::ceil(d.pulse_hz / d.scan_hz - 1e-9) : 1;
  require_data(pulses >= 1 && pulses <= kMostPulses, "between 1 and 1000000 pulses a line");
  std::vector<Vec3> line(static_cast<size_t>(pulses), Vec3::UnitY());
  if (d.scan_hz <= 0) return line;  // The mirror stands still.
  if (d.optics == "oscillating") oscillate(d, line);
  if (d.optics == "rotating") turn(d, line);
  if (d.optics == "conic") circle(d, line);
  return line;
}

}  // namespace underbrush::worlds
