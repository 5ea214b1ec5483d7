/// \file
/// What verbs say about the light of models and the intensities that these answer.
#pragma once
#include <span>
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::report {

/// The light of a model (`pipeline::json_of_light`) in one line, with the extremes of the gains of
/// channels; empty without light.
std::string text_of_light(const elements::Model& model);

/// Says in one line where intensities come from and what is assumed of them: from the light that
/// the models have learnt, or from radiometry and materials if `instrument`. `asking` is the sensor
/// of the beams, with its wavelength where it is known. Empty where no model has light.
std::string intensities_in_words(std::span<const elements::Model> models, const LogInfo& asking,
                                 bool instrument);

}  // namespace underbrush::report
