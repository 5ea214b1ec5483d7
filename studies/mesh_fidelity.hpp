/// The parts of the study of [goodin24]: the fineness that a plant's model needs for a realistic
/// simulated cloud.
#pragma once
#include <filesystem>
#include <optional>

#include "studies/study.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/metrics/leaf_inclination.hpp"
#include "underbrush/test_site/plant_mesh.hpp"

namespace underbrush::studies {

/// A plant at the origin, in a box of 45 m³ as in the paper.
struct SweepPlant {
  std::string name;
  test_site::PlantMesh plant;
  bool crude = false;  ///< Whether it is a billboard or a cartoon, which has no more than a shape.
};
/// Returns 27 plants, as many as in the paper: billboards, cartoons, then broadleaved trees,
/// conifers and shrubs from some large leaves to millions of triangles. With `quick` these are a
/// billboard, a cartoon and two trees.
std::vector<SweepPlant> sweep_plants(bool quick, uint64_t seed);
/// Returns the meshes of a folder (.obj, .ply; z up), scaled to 45 m³; nothing if there is no such
/// folder.
std::vector<SweepPlant> given_plants(const std::filesystem::path& folder);

/// The approach of a vehicle to a plant, and the registration of its scans.
struct ApproachOptions {
  double tilt_rad = 0.026;    ///< Amplitude of pitch and roll, at about 1 Hz.
  double heave_m = 0.03;      ///< Amplitude of the vertical motion.
  double registration_m = 0;  ///< Standard deviation of the registration of a scan along each axis.
  double registration_rad = 0;  ///< Standard deviation of the registration of a scan about each
                                ///< axis.
  const char* sensor = "ouster-os1-64";  ///< Name in the sensor catalogue.
  bool lower = true;                     ///< Whether there is a second sensor below the first.
  double from_m = 17, to_m = 2;  ///< Distances before the plant's front; the speed is 2.5 m/s.
};
/// Registration by lidar odometry: 2 cm and 0.1°.
inline constexpr ApproachOptions kOdometry{0.026, 0.03, 0.02, 0.0017};
/// A vehicle on a flat floor, with exact registration.
inline constexpr ApproachOptions kSmooth{0, 0, 0, 0};

/// Returns the beams that the sensors on an approaching vehicle send towards the plant. The upper
/// one is a metre above and 1.4 m behind the lower one. With `quick` only every eighth scan is
/// taken.
BeamLog approach_beams(const test_site::PlantMesh& plant, bool quick,
                       const ApproachOptions& options);
/// The simulation of the beams of an approach.
struct RangingOptions {
  std::optional<double> sigma_m;  ///< Standard deviation of the range noise; none: the sensor's.
  int sub_rays = 9;
};
/// Scans the plant with the footprint, range noise and resolution of the beams' sensor, by the ray
/// caster of all generated realities (`simulate::scan`): the plant is judged, not the instrument.
BeamLog approach_scan(const test_site::PlantMesh& plant, const BeamLog& beams, uint64_t seed,
                      const RangingOptions& ranging = {});
/// Returns the end points of all hits with the errors of registration.
std::vector<Vec3f> registered(const BeamLog& log, const ApproachOptions& options, uint64_t seed);

/// The scores of a plant, or of the ellipsoids fitted to a scan of it.
struct PlantFigures {
  std::string name;
  size_t elements = 0;  ///< Number of triangles or ellipsoids.
  size_t bytes = 0;     ///< Size of the vertices and triangles, or of the ellipsoids.
  bool crude = false;
  metrics::LeafInclination leaves;     ///< With exact poses, as in a simulator.
  metrics::LeafInclination displaced;  ///< With errors of registration.
};
/// Scores a plant by a scan of it.
PlantFigures figures_of(const SweepPlant& plant, const BeamLog& scan, uint64_t seed);
/// Fits ellipsoids to `scan` and scores their returns for the same beams.
PlantFigures ellipsoids_of(const BeamLog& scan, uint64_t seed);

/// Returns points drawn uniformly from the surface, which show the plant without a lidar.
std::vector<Vec3f> surface_points(const test_site::PlantMesh& plant, size_t n, uint64_t seed);

/// Returns the thresholds: all billboards and cartoons outside ε ≤ 0.11, the finest plant inside,
/// and ε falling with ln n.
std::vector<Check> sweep_checks(const std::vector<PlantFigures>& plants,
                                const metrics::LogRegression& line);

/// Adds the score of one plant with and without each effect that shapes its cloud.
void add_conditions(const StudyRun& run, const SweepPlant& plant, StudyResult& result);

/// Adds the scores of one plant of each kind with other sensors, from a whole approach and from one
/// scan.
void add_sensors(const StudyRun& run, const std::vector<SweepPlant>& plants, StudyResult& result);

/// Returns a score as JSON.
Json json_of(const metrics::LeafInclination& l);
/// Returns a score as cells of a table: points, μ, σ, ε, inside or outside.
std::vector<std::string> cells(const metrics::LeafInclination& l);

/// Adds the scores of the real clouds of `run.data`: the vegetation of logs, and point files as
/// they are.
void add_real_vegetation(const StudyRun& run, StudyResult& result);

}  // namespace underbrush::studies
