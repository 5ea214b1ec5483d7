#include "underbrush/keyframes/changed_pixels.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/credit/crossing_beams.hpp"
#include "underbrush/credit/hit_probability.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::keyframes {
namespace {

using elements::Keyframe;
using elements::Keyframes;

/// The beam of a pixel (relative to the model's origin, m), and up to where it met what changed.
struct PixelBeam {
  Ray ray;
  double reach_m;
};

PixelBeam beam_of(const Keyframes& k, const Keyframe& f, size_t pixel, double max_range_m) {
  const size_t row = pixel / k.columns, column = pixel % k.columns;
  const Vec3 from = f.column_origin[column].cast<double>();
  if (f.pixels[pixel].is_hit()) {
    const Vec3 way = k.point(f.pixels[pixel]) - from;
    const double behind_m = credit::CreditOptions().max_residual_for_hit_m;
    return {{f.origin + from, way.normalized()}, way.norm() + behind_m};
  }
  const double azimuth = (double(column) + 0.5) / double(k.columns) * 2 * M_PI;
  const double flat = std::cos(k.elevation[row]);
  const Vec3 seen(flat * std::cos(azimuth), flat * std::sin(azimuth), std::sin(k.elevation[row]));
  return {{f.origin + from, f.sensor_from_world.conjugate() * seen}, max_range_m};
}

}  // namespace

size_t forget_changed(Keyframes& k, const elements::Model& changed) {
  if (changed.ellipsoids.empty()) return 0;
  const trace::World world(changed);
  std::atomic<size_t> forgotten = 0;
  for (Keyframe& f : k.frames) {
    parallel_for(f.pixels.size(), 8192, [&](size_t begin, size_t end) {
      std::vector<size_t> pixels;
      std::vector<Ray> rays;
      std::vector<double> reach_m;
      for (size_t p = begin; p < end; ++p) {
        if (f.pixels[p].is_unknown()) continue;
        PixelBeam beam = beam_of(k, f, p, changed.max_range_m);
        beam.ray.origin += changed.origin;
        pixels.push_back(p);
        rays.push_back(beam.ray);
        reach_m.push_back(beam.reach_m);
      }
      const std::vector<uint8_t> meets = credit::meet_something(world, rays, reach_m);
      for (size_t r = 0; r < rays.size(); ++r) {
        if (meets[r]) f.pixels[pixels[r]] = {};
      }
      forgotten += size_t(std::count(meets.begin(), meets.end(), 1));
    });
  }
  return forgotten;
}

}  // namespace underbrush::keyframes
