/// \file
/// The pixels of keyframes that show things that are no longer there.
#pragma once
#include "underbrush/elements/keyframes.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::keyframes {

/// Makes the pixels unknown whose beams met an ellipsoid of `changed`: up to 0.75 m behind their
/// returns, or up to the model's largest range where they had none. Returns their number.
size_t forget_changed(elements::Keyframes& keyframes, const elements::Model& changed);

}  // namespace underbrush::keyframes
