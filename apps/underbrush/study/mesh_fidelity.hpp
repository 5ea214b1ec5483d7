/// The parts of the study of [goodin24]: how fine a plant must be modelled for a lidar's cloud of
/// it to look real.
#pragma once
#include "study/study.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/metrics/leaf_inclination.hpp"
#include "underbrush/scene/plant_mesh.hpp"

namespace underbrush::app {

/// A plant at the origin, in a box of 45 m³ as in the paper.
struct SweepPlant {
  std::string name;
  scene::PlantMesh plant;
};
/// `billboard` (one board) and `cartoon` (ball on a stick), then trees from coarse to fine.
std::vector<SweepPlant> sweep_plants(bool quick, uint64_t seed);

/// The beams that two OS1-64 on an approaching vehicle send towards the plant: 2.5 m/s from 18 m to
/// 6 m before it, the upper sensor one metre above and 1.4 m behind the lower one.
BeamLog approach_beams(const scene::PlantMesh& plant, bool quick);
/// The same answered by the plant, with footprint, σ and resolution of the sensor.
BeamLog approach_scan(const scene::PlantMesh& plant, const BeamLog& beams, uint64_t seed);

/// Of all hits, registered.
metrics::LeafInclination leaves_of(const BeamLog& log);

/// One plant, or the ellipsoids fitted to a scan of one.
struct PlantFigures {
  std::string name;
  size_t elements = 0;  ///< Triangles or ellipsoids.
  size_t bytes = 0;     ///< Of vertices and triangles, or of the ellipsoids.
  metrics::LeafInclination leaves;
};
PlantFigures figures_of(const SweepPlant& plant, const BeamLog& scan);
/// Fits ellipsoids to `scan` and scores what they answer to the same beams.
PlantFigures ellipsoids_of(const BeamLog& scan, uint64_t seed);

/// The thresholds: flat and cartoon plants outside ε ≤ 0.11, the finest inside, ε falls with ln n.
std::vector<Check> sweep_checks(const std::vector<PlantFigures>& plants,
                                const metrics::LogRegression& line);

/// The real clouds of `run.data`: vegetation of logs with a train.ply, and point files as they are.
void add_real_vegetation(const StudyRun& run, StudyResult& result);

}  // namespace underbrush::app
