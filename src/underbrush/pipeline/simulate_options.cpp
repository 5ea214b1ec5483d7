#include "underbrush/pipeline/simulate_options.hpp"

#include <charconv>

#include "underbrush/core/check.hpp"

namespace underbrush::pipeline {
// long: the table of the options.
std::span<const Option<SimulateOptions>> simulate_options() {
  using O = SimulateOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"actors", "", "", "Add things that move: a folder that actors wrote, or a list of edits of one",
     [](O& o) -> auto& { return o.actors; }, -kNoLimit, kNoLimit, {}, "FOLDER|FILE.json"},
    {"element-ids", "", "",
     "Add columns for the element at which each beam ended and for its class; for a scene also for "
     "its instance",
     [](O& o) -> auto& { return o.element_ids; }},

    {"beams", kPartsGroup, "",
     "Simulate only the beams FIRST to END - 1; the first beam has the number 0. These beams get "
     "the same results as in a simulation of all beams",
     [](O& o) -> auto& { return o.beams; }, -kNoLimit, kNoLimit, {}, "FIRST:END"},
    {"memory", kPartsGroup, "", regions::kMemoryHelp,
     [](O& o) -> auto& { return o.memory; }, -kNoLimit, kNoLimit, {}, "SIZE"},

    {"super-sample", "Instrument", "",
     "Trace several sub-rays in each beam and compute light, waveform and echoes: a number, "
     "COLUMNSxROWS, or sensor for the number in the sensor's data file",
     [](O& o) -> auto& { return o.instrument.super_sample; }, -kNoLimit, kNoLimit, {}, "N|NxM|sensor"},
    {"returns", "Instrument", "",
     "The reported echoes: strongest, first, last, or up to N (default: those of the sensor)",
     [](O& o) -> auto& { return o.instrument.returns; }, -kNoLimit, kNoLimit, {}, "MODE|N"},

    {"matter", "Matter", "",
     "How leaves and stones are drawn at random: once = one draw for the whole simulation, so that "
     "neighbouring beams and later scans meet the same leaves, which sway if fit found that they "
     "do; still = the same without sway; anew = a new draw for each beam",
     [](O& o) -> auto& { return o.matter; }, -kNoLimit, kNoLimit, {"once", "still", "anew"}},
    {"grain", "Matter", "m",
     "Side of the cells within which matter is drawn as one, unless it is drawn anew; 0 = as in the model",
     [](O& o) -> auto& { return o.grain_m; }, 0, 100},
    {"tau", "Matter", "",
     "Mahalanobis distance within which a beam meets an ellipsoid; 0 = as in the model",
     [](O& o) -> auto& { return o.tau; }, 0, 20},
    {"wind", "Matter", "s",
     "Correlation time of swaying leaves; 0 = the time that fit learnt, or no sway if it learnt "
     "none",
     [](O& o) -> auto& { return o.sway_s; }, 0, 3600},
    {"support", "Matter", "",
     "Add a column with the probability that a beam does not end in unknown space",
     [](O& o) -> auto& { return o.support; }},

    {"draw", "Thin rays", "",
     "How the range of a beam is chosen: on_ray = at random along the beam; volumetric = at random "
     "in the volume of the ellipsoid; median = the median of the beam's distribution, which has "
     "the least error",
     [](O& o) -> auto& { return o.draw; }, -kNoLimit, kNoLimit, {"on_ray", "volumetric", "median"}},
    {"intensity", "Thin rays", "",
     "The intensity of a return, for models of logs with intensities: mean = the expected "
     "intensity of the element; drawn = a random one with the spread of the element",
     [](O& o) -> auto& { return o.intensity; }, -kNoLimit, kNoLimit, {"mean", "drawn"}},
    {"beam", "Thin rays", "",
     "Where the ray of a beam is traced: thin = on the axis; random = in a random direction within "
     "the cone of the sensor's beam",
     [](O& o) -> auto& { return o.beam; }, -kNoLimit, kNoLimit, {"thin", "random"}},
    {"max-range", "Thin rays", "m", "Maximum range; 0 = that of the log or sensor",
     [](O& o) -> auto& { return o.max_range_m; }, 0, 1e6},
    {"range-noise", "Thin rays", "m", "Standard deviation of additional noise on every range",
     [](O& o) -> auto& { return o.range_noise_m; }, 0, 100},

    {"all-sub-rays", "Sub-rays", "",
     "Trace all sub-rays of every beam; without this option, a beam of 26 or more sub-rays is "
     "computed from 13 of them where their ranges agree",
     [](O& o) -> auto& { return o.instrument.all_sub_rays; }},

    {"materials", "Light and air", "", "A table of materials that replaces the built-in one",
     [](O& o) -> auto& { return o.instrument.materials; }, -kNoLimit, kNoLimit, {}, "FILE.yaml"},
    {"material", "Light and air", "", "The material of a class; may be repeated",
     [](O& o) -> auto& { return o.instrument.material; }, -kNoLimit, kNoLimit, {}, "CLASS=MATERIAL"},
    {"visibility", "Light and air", "m", "Visibility in haze or fog; 0 = clear air",
     [](O& o) -> auto& { return o.instrument.visibility_m; }, 0, 1e7},
    {"rain", "Light and air", "mm/h", "Rain rate",
     [](O& o) -> auto& { return o.instrument.rain_mm_per_h; }, 0, 1000},
    {"sun", "Light and air", "",
     "Share of the sunlight that passes the air, which adds to the receiver's noise; 0 = night",
     [](O& o) -> auto& { return o.instrument.sun; }, 0, 1},

    {"waveform-every", kWaveformsGroup, "", "Write the waveforms of beams 0, K, 2K, …",
     [](O& o) -> auto& { return o.waveform.every; }, 1, kNoLimit, {}, "K"},
    {"waveform-count", kWaveformsGroup, "", "Largest number of waveforms in tables and plots",
     [](O& o) -> auto& { return o.waveform.count; }, 1, 1e6, {}, "N"},
  };
// clang-format on
return kOptions;
}

void SimulateOptions::check() const {
  check_options("simulate", simulate_options(), *this);
  beam_range(beams);
  const InstrumentOptions& i = instrument;
  const bool light = !i.returns.empty() || !i.materials.empty() || !i.material.empty() ||
                     i.visibility_m > 0 || i.rain_mm_per_h > 0 || i.sun > 0 || on_waveforms;
  require(!i.super_sample.empty() || !light,
          "simulate: returns, materials, air, sun and waveforms need --super-sample");
  require(i.super_sample.empty() ||
              (beam == "thin" && draw == "on_ray" && range_noise_m == 0 && intensity == "mean"),
          "simulate: --beam, --draw, --intensity and --range-noise are of thin rays, not of "
          "--super-sample");
}

BeamRange beam_range(const std::string& text) {
  BeamRange out;
  if (text.empty()) return out;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, out.first);
  const bool two = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
  const auto last = two ? std::from_chars(first.ptr + 1, end, out.end) : first;
  if (!two || last.ec != std::errc() || last.ptr != end || out.first >= out.end) {
    throw std::invalid_argument("simulate: beams is FIRST:END with FIRST < END, not " +
                                in_quotes(text));
  }
  return out;
}

}  // namespace underbrush::pipeline
