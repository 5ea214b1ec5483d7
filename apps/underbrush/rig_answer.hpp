/// \file
/// The answers of `simulate` to the beams of a rig: each sensor has its own instrument.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "answer.hpp"
#include "underbrush/perception/rig_source.hpp"

namespace underbrush::app {

/// Answers the beams of a rig in place. All sensors see the same matter: they share the seed, and
/// their beams have different numbers.
class RigAnswer {
 public:
  /// Makes the answer of a sensor.
  using Make = std::function<std::unique_ptr<Answer>(const sensor::Sensor&)>;
  RigAnswer(const std::vector<sensor::Sensor>& sensors, const Make& make);

  /// Answers beams with the column `sensor`; `first_beam` is the number of the first, and chunks
  /// come in order.
  void operator()(size_t first_beam, BeamLog& beams);
  size_t sub_rays() const { return answers_[0]->sub_rays(); }
  size_t rays_traced() const;
  /// Writes the waveforms of the first sensor.
  void write_waveforms() { answers_[0]->write_waveforms(); }

 private:
  std::vector<LogInfo> limits_;
  std::vector<std::unique_ptr<Answer>> answers_;
  std::vector<size_t> fired_;
};

}  // namespace underbrush::app
