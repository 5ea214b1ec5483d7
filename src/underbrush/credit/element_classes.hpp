/// \file
/// Classes of a model's ellipsoids, from a labelled log.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::credit {

/// Gives each ellipsoid the class of most of the hits that it explains, by the extra column `class`
/// of the log and the label set that the log names. A hit belongs to the element that explains its
/// range best (`credit` with the rule "best"). Classes that Underbrush does not have are added to
/// `model.class_names`. The grain of the most frequent classes becomes the usual one
/// (`elements::usual_grain_m`). A log without labels leaves the model as it is. If `wanted` is
/// given (one value for each element), only the wanted elements get a class, and the grain stays.
void learn_classes(elements::Model& model, BeamSource& log, const std::vector<bool>& wanted = {});

}  // namespace underbrush::credit
