/// \file
/// The pixels of keyframes that show what is there no more.
#pragma once
#include "underbrush/elements/keyframes.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::keyframes {

/// Makes the pixels unknown whose beams met an ellipsoid of `changed`: up to 0.75 m behind their
/// returns, or up to the model's largest range where they had none. Returns how many.
size_t forget_changed(elements::Keyframes& keyframes, const elements::Model& changed);

}  // namespace underbrush::keyframes
