/// \file
/// This file lists the densities of a composed scene's classes as parameters.
#pragma once
#include "underbrush/optimize/parameter.hpp"
#include "underbrush/primitives/annotation.hpp"

namespace underbrush::optimize {

/// Makes one parameter for each class of the annotation, in the order of `elements::Class` and
/// under the class's name. Its value is the number of objects for each annotated one, from 0.1 to
/// 4.
std::vector<Parameter> density_parameters(const primitives::Annotation& annotation);

}  // namespace underbrush::optimize
