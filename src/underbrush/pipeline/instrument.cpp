#include "underbrush/pipeline/instrument.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/radiometry/link_budget.hpp"

namespace underbrush::pipeline {
namespace {

constexpr int kMostLines = 128, kMostSubRays = kMostLines * kMostLines;

/// Parses a whole number from 1 to `most`.
int whole(std::string_view word, int most) {
  const auto n = io::number_of(word);
  require(n && *n == std::floor(*n) && *n >= 1 && *n <= most,
          "simulate: --super-sample takes N up to 16384, COLUMNSxROWS up to 128 each, or sensor");
  return int(*n);
}

std::vector<sensor::SubRay> sub_rays_of(const std::string& word, const sensor::Sensor& s) {
  if (word == "sensor") return sensor::grid_sub_rays(s.beam, s.sub_rays[0], s.sub_rays[1]);
  const size_t cross = word.find('x');
  if (cross == std::string::npos) return sensor::spread_sub_rays(s.beam, whole(word, kMostSubRays));
  return sensor::grid_sub_rays(s.beam, whole(std::string_view(word).substr(0, cross), kMostLines),
                               whole(std::string_view(word).substr(cross + 1), kMostLines));
}

void set_returns(const std::string& word, radiometry::ReceiverOptions& o) {
  using radiometry::ReturnMode;
  if (word.empty()) return;
  o.max_echoes = 1;
  if (word == "strongest") {
    o.mode = ReturnMode::kStrongest;
  } else if (word == "first") {
    o.mode = ReturnMode::kFirst;
  } else if (word == "last") {
    o.mode = ReturnMode::kLast;
  } else {
    const auto n = io::number_of(word);
    require(n && *n == std::floor(*n) && *n >= 1 && *n <= radiometry::Echoes::kMost,
            "simulate: --returns takes strongest, first, last or a number of 1 to 16");
    o.mode = ReturnMode::kAll;
    o.max_echoes = int(*n);
  }
}

/// Returns the variance that sunlight from a white scene adds to the noise of a receiver that sees
/// the beam's divergence.
double sunlit_variance(const sensor::Sensor& s, double share) {
  if (share == 0) return 0;
  radiometry::LinkBudget link;
  if (s.wavelength_m > 0) link.wavelength_m = s.wavelength_m;
  const double view = std::max(s.beam.divergence_rad[0], s.beam.divergence_rad[1]);
  if (view > 0) link.view_rad = view;
  const double noise =
      radiometry::noise_in_light(link, radiometry::solar_background_w(link, 1, share));
  return noise * noise - 1;
}

}  // namespace

simulate::Instrument instrument_of(const InstrumentOptions& a, sensor::Sensor s,
                                   const std::optional<sensor::Sensor>& recorder) {
  double air = radiometry::rain_extinction_per_m(a.rain_mm_per_h);
  if (a.visibility_m > 0) air += radiometry::fog_extinction_per_m(a.visibility_m, s.wavelength_m);
  const double sunlit = sunlit_variance(s, a.sun);
  simulate::Instrument instrument;
  instrument.sub_rays = sub_rays_of(a.super_sample, s);
  if (recorder) {
    const double step = s.beam.encoder_step_rad, known = recorder->beam.encoder_step_rad;
    s.beam.encoder_step_rad = std::sqrt(std::max(0.0, step * step - known * known));
    instrument.fitted_beam = recorder->beam;
  }
  if (recorder && recorder->name == s.name) {
    s.range_sigma_m = recorder->range_sigma_m;
    s.max_range_m = recorder->max_range_m;
  }
  instrument.beam = s.beam;
  instrument.receiver = radiometry::receiver_options(s, air, sunlit);
  set_returns(a.returns, instrument.receiver);
  return instrument;
}

bool has_learnt_light(const InstrumentOptions& a, const sensor::Sensor& s,
                      const std::optional<sensor::Sensor>& recorder) {
  return recorder && recorder->name == s.name && a.materials.empty() && a.material.empty() &&
         a.visibility_m == 0 && a.rain_mm_per_h == 0;
}

radiometry::Materials materials_of(const InstrumentOptions& a,
                                   const simulate::InstanceKinds& kinds) {
  radiometry::Materials m = simulate::with_own_materials(radiometry::load_materials(a.materials),
                                                         kinds, a.materials.empty());
  const auto is_class = [&](const std::string& name) {
    return elements::class_from_name(name) ||
           std::find(kinds.class_names.begin(), kinds.class_names.end(), name) !=
               kinds.class_names.end();
  };
  for (const std::string& word : a.material) {
    const size_t equals = word.find('=');
    require(equals != std::string::npos && is_class(word.substr(0, equals)),
            "simulate: --material takes CLASS=MATERIAL with a class that `info` names");
    const std::string label = word.substr(0, equals), name = word.substr(equals + 1);
    m.named(name);  // This throws for an unknown name.
    std::erase_if(m.of_class, [&](const auto& entry) { return entry.first == label; });
    m.of_class.emplace_back(label, name);
  }
  return m;
}

}  // namespace underbrush::pipeline
