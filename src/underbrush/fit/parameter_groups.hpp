/// \file
/// The groups of the parameters of a fit.
#pragma once
#include <string_view>

namespace underbrush::fit {

/// The parts of a fit that parameters belong to: the groups of the table. Each fitter has the
/// parameters of some of them.
namespace group {
inline constexpr std::string_view kCommon = "every fitter", kHierarchical = "hierarchical",
                                  kVoxel = "voxel", kTopDown = "top_down", kBottomUp = "bottom_up",
                                  kSurface = "surface, rimls", kGround = "ground",
                                  kEllipsoids = "ellipsoids", kHitProbability = "hit probability",
                                  kLikelihood = "likelihood";
/// All groups, in the order of reference pages.
inline constexpr std::string_view kAll[] = {kCommon,         kHierarchical, kVoxel,  kTopDown,
                                            kBottomUp,       kSurface,      kGround, kEllipsoids,
                                            kHitProbability, kLikelihood};
}  // namespace group

}  // namespace underbrush::fit
