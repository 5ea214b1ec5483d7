// Fires a thousand beams at one half-permeable ellipsoid. It exits with 0 if about half of them end
// there.
#include <cstdio>

#include "underbrush/pipeline/simulation.hpp"

int main() {
  using namespace underbrush;
  elements::Model model;
  elements::Ellipsoid shrub;
  shrub.mean = Vec3f(10, 0, 0);
  shrub.hit.p = 0.5f;
  model.ellipsoids.push_back(shrub);
  model.check();

  BeamLog beams;
  beams.resize(1000);
  pipeline::SimulateOptions options;
  options.matter = "anew";  // a trial of its own for each beam
  const pipeline::TracedWorld world(model, pipeline::matter_of(options));
  pipeline::Simulation(world, options).answer(0, beams);
  size_t hits = 0;
  for (size_t i = 0; i < beams.size(); ++i) hits += beams.is_hit(i);
  std::printf("%zu of %zu beams hit\n", hits, beams.size());
  return hits > 400 && hits < 600 ? 0 : 1;
}
