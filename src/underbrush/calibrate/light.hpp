/// \file
/// Learns reflectances and the sensor's intensity response from a log.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::calibrate {

/// Returns from which the reflectance of an element is learnt, about.
inline constexpr size_t kSamplesOfLight = 6;

/// Learns the response of the log's sensor and the reflectance of each element from the intensities
/// of the returns that it explains best (`explaining_elements`). The reflectances of elements with
/// few returns are shrunk towards the mean of their class, where the log had labels, or else of
/// their kind (`reflectances`). About `samples_an_element` returns for each element are used, at
/// least about 2¹⁷ and at most 2²², which are chosen by a hash of their number; the response is
/// fitted to about 2¹⁶ of them (`fit_response`). The log is read once. Only the light of the model
/// changes. It stays empty if the intensities of the log are all 0, or too large for a float.
void learn_light(elements::Model& model, BeamSource& log,
                 size_t samples_an_element = kSamplesOfLight);

/// Learns the reflectances of some elements from the returns of a log, with the response that the
/// model has. `wanted` has one value for each element; the other elements keep their reflectances.
/// A model without light does not change, nor does one in which no element is wanted.
void learn_reflectances(elements::Model& model, BeamSource& log, const std::vector<bool>& wanted);

}  // namespace underbrush::calibrate
