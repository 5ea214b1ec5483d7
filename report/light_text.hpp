/// \file
/// The texts of verbs on the light of models, and on the intensities of returns from them.
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

/// Returns one line on the source of intensities and the assumptions about them: from the light
/// that the models have learnt if `is_learnt`, else from radiometry and materials. `asking` is the
/// sensor of the beams, with its wavelength where it is known. Empty where no model has light.
std::string intensities_in_words(std::span<const elements::Model> models, const LogInfo& asking,
                                 bool is_learnt);

}  // namespace underbrush::report
