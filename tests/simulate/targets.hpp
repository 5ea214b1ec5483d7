// This file makes worlds of rectangles, and instruments without noise.
#pragma once
#include "underbrush/simulate/echoes.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::simulate {

/// Adds the parallelogram at `corner` with sides a and b to the surface.
inline void add_sheet(elements::Model& model, const Vec3& corner, const Vec3& a, const Vec3& b) {
  auto& mesh = model.surface;
  const auto first = uint32_t(mesh.vertices.size());
  for (const Vec3& v : {corner, Vec3(corner + a), Vec3(corner + a + b), Vec3(corner + b)}) {
    mesh.vertices.push_back(v.cast<float>());
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.hit.resize(mesh.triangles.size());
}

/// Adds a wall at x = `range`, from y0 to y1, 40 m high, whose top leans away by `tilt_rad`.
inline void add_wall(elements::Model& model, double range, double y0 = -20, double y1 = 20,
                     double tilt_rad = 0) {
  const Vec3 up(std::sin(tilt_rad), 0, std::cos(tilt_rad));
  add_sheet(model, Vec3(range, y0, 0) - 20 * up, Vec3(0, y1 - y0, 0), 40 * up);
}

inline BeamLog beams_along_x(size_t n, double max_range = 100) {
  BeamLog log;
  log.info.max_range_m = max_range;
  log.resize(n);
  return log;
}

/// Makes an instrument 20 mrad wide with samples of 0.15 m, without noise and rounding. It reports
/// all echoes, and their signal as intensity.
inline Instrument quiet_instrument(int columns = 9, int rows = 9) {
  Instrument i;
  i.beam = sensor::round_beam(0.02, 0);
  i.sub_rays = sensor::grid_sub_rays(i.beam, columns, rows);
  i.receiver.noise_sigma = 0;
  i.receiver.false_alarms = false;
  i.receiver.signal_at_1m = 1e6;
  i.receiver.mode = radiometry::ReturnMode::kAll;
  i.receiver.max_echoes = 8;
  return i;
}

/// Makes a table in which everything is made of `material`.
inline radiometry::Materials all_of(const char* material) {
  radiometry::Materials m = radiometry::load_materials();
  m.of_class = {{"unknown", material}};
  return m;
}

inline BeamLog answered(const elements::Model& model, const Instrument& instrument, BeamLog beams,
                        const char* material = "white_target", const EchoOptions& options = {}) {
  const trace::World world(model);
  const DynamicWorld dynamic_world(world);
  const Reflection reflection(all_of(material), 905e-9);
  EchoMaker(dynamic_world, reflection, instrument, options).answer(0, beams);
  return beams;
}

template <class T>
const std::vector<T>& column(const BeamLog& log, const char* name) {
  return std::get<std::vector<T>>(log.extra.at(name));
}

}  // namespace underbrush::simulate
