/// \file
/// The plants of the test site.
#pragma once
#include "underbrush/test_site/test_site.hpp"

namespace underbrush::test_site {

/// Which prototypes are of which kind: ranges of their indices.
struct PrototypeRange {
  uint32_t begin = 0, end = 0;
};

/// A dozen trees of 4 to 14 m, shrubs of 0.35 to 2.8 m, tussocks of tall grass, tufts of short
/// grass.
struct PrototypeSet {
  std::vector<Prototype> prototypes;
  PrototypeRange trees, shrubs, tussocks, mowed;
};
/// The same set for the same seed. With a `variation` above 1 the species are others than the
/// site's: crown radius and base, trunk, leaf area index and leaf size of each are multiplied by
/// factors drawn from [1 / variation, variation], evenly by their logarithm. Throws
/// `std::invalid_argument` for a variation outside [1, 2].
PrototypeSet make_prototypes(uint64_t seed, double variation = 1);

}  // namespace underbrush::test_site
