/// The ladder from a composed scene to the fit of the test log itself.
#pragma once
#include "studies/primitives.hpp"

namespace underbrush::studies {

/// A rung: a world that is true in one more respect than the world of the rung before it.
struct Rung {
  std::string name;
  metrics::Summary score;
};

/// Composes a scene for a pair as `run_pair` does, makes it true in one respect after the other,
/// and simulates and scores each world on the beams of `test`. The last rung is always hit, for
/// comparison. The first rung is the scene composed by the option `--choose box`. The rungs have
/// the same names and order for every pair.
std::vector<Rung> ladder(const SitePair& pair, uint64_t seed);

/// Returns the distance between the shapes of two primitives, m: the mean distance from an
/// ellipsoid of one to the nearest of the other, weighted by hits and averaged over both
/// directions.
double shape_distance(const elements::Model& a, const elements::Model& b);

/// Returns one model with the elements of all instances; triangles other than those of the first
/// instance, the ground, are left out.
elements::Model flattened(const elements::Scene& scene);

}  // namespace underbrush::studies
