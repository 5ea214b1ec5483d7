/// \file
/// The light of a model: what intensities a log has taught its elements to answer.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::calibrate {

/// Learns the response of the log's sensor and the reflectance of each element from the intensities
/// of the returns that it explains best (`explaining_elements`). Elements with few returns are
/// drawn towards the mean of their class, where the log had labels, or else of their kind
/// (`reflectances`). Some six returns an element are looked at, chosen by a hash of their number,
/// at least about 2¹⁷ and at most 2²²; the response is fitted to about 2¹⁶ of them
/// (`fit_response`). The log is read once. Nothing but the light of the model changes; a log whose
/// intensities are all 0, or beyond what a reflectance can be as a float, leaves it without.
void learn_light(elements::Model& model, BeamSource& log);

/// Learns the reflectances of some elements from the returns of a log, with the response that the
/// model has. `wanted` has one value for each element; the other elements keep their reflectances.
/// A model without light does not change, nor does one in which no element is wanted.
void learn_reflectances(elements::Model& model, BeamSource& log, const std::vector<bool>& wanted);

}  // namespace underbrush::calibrate
