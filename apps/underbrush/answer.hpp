/// \file
/// The answers of `simulate` to beams: as thin rays, or as an instrument sees them.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "instrument.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "waveform_file.hpp"

namespace underbrush::app {

/// The options of an answer.
struct AnswerArguments {
  std::string draw = "on_ray", beam = "thin", intensity = "mean";
  simulate::Options simulate;
  InstrumentArguments instrument;
};

/// Returns how matter is drawn: `matter` is "once" or "anew", and what is drawn once may sway, with
/// a correlation time in s. Throws `std::invalid_argument` where matter that is drawn anew should
/// sway.
trace::Draws draws_of(const std::string& matter, double sway_s);

/// Answers beams in place: as thin rays, or with `--super-sample` as an instrument.
class Answer {
 public:
  /// Returns the sensor of the beams, or throws `std::invalid_argument`, which says that the option
  /// `what` needs one. It is called only where a sensor is needed.
  using SensorOf = std::function<sensor::Sensor(const char* what)>;

  /// `recorder` is what `recorder_of` gives for the world's models. `world` must outlive it. Throws
  /// `std::invalid_argument` for options out of range or without effect.
  Answer(AnswerArguments a, const simulate::DynamicWorld& world,
         const simulate::InstanceKinds& kinds, const std::optional<sensor::Sensor>& recorder,
         const SensorOf& sensor_of);

  /// Answers beams; `first_beam` is the number of the first.
  void operator()(size_t first_beam, BeamLog& beams);
  /// Returns the number of sub-rays of a beam, 0 for thin rays.
  size_t sub_rays() const { return maker_ ? instrument_.sub_rays.size() : 0; }
  /// Returns the number of sub-rays that were traced so far.
  size_t rays_traced() const { return maker_ ? maker_->rays() : 0; }
  /// Writes the waveforms to every file asked for; none for thin rays.
  void write_waveforms();

 private:
  void take_waveforms();
  void set_up(const simulate::InstanceKinds& kinds, const std::optional<sensor::Sensor>& recorder,
              const SensorOf& sensor_of);

  AnswerArguments a_;
  const simulate::DynamicWorld& world_;
  sensor::Sensor sensor_;
  simulate::Instrument instrument_;
  std::unique_ptr<simulate::Reflection> reflection_;
  std::unique_ptr<simulate::EchoMaker> maker_;
  /// The waveforms for tables and plots, and files of the waveforms of all beams.
  std::vector<simulate::BeamWaveform> waveforms_;
  std::vector<std::unique_ptr<WaveformFile>> files_;
};

}  // namespace underbrush::app
