/// \file
/// The light of the elements of a model.
#pragma once
#include "underbrush/elements/model.hpp"

namespace underbrush::elements {

/// The cosine of incidence of a ray with the unit vector `direction` (model frame) on an element.
/// For a triangle it is |n·d|. For an ellipsoid with the covariance Σ it is
/// √(dᵀΣ⁻¹d / tr Σ⁻¹), which tends to |n·d| for a flat one and is 1/√3 in every direction for a
/// ball, because a volume has no surface to incline.
double incidence_cosine(const Model& model, size_t element, const Vec3& direction);

/// The reflectance of an element; zeros where the model has no light.
Reflectance reflectance(const Model& model, size_t element);

/// Computes the mean and the standard deviation of the reflectances of a kind of element, in which
/// an element counts once and as often as it was hit; zeros where there are no elements.
MeanReflectance mean_reflectance(const Model& model, Kind kind);

}  // namespace underbrush::elements
