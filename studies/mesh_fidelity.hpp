/// The parts of the study of [goodin24]: how fine a plant must be modelled for a lidar's cloud of
/// it to look real.
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
  bool crude = false;  ///< A board or a cartoon, of no more than a shape.
};
/// 27 plants, as many as in the paper: boards, cartoons, then broadleaved trees, conifers and
/// shrubs from some large leaves to millions of triangles. `quick`: a board, a cartoon and two
/// trees.
std::vector<SweepPlant> sweep_plants(bool quick, uint64_t seed);
/// The meshes of a folder (.obj, .ply; z up), scaled likewise; none if there is no such folder.
std::vector<SweepPlant> given_plants(const std::filesystem::path& folder);

/// How a vehicle comes near and how well its scans are registered.
struct ApproachOptions {
  double tilt_rad = 0.026;               ///< Amplitude of pitch and roll, about 1 Hz.
  double heave_m = 0.03;                 ///< Amplitude.
  double registration_m = 0;             ///< σ of a scan's registration, each axis.
  double registration_rad = 0;           ///< The same of its turn.
  const char* sensor = "ouster-os1-64";  ///< Of the catalogue.
  bool lower = true;                     ///< Whether there is one below the other.
  double from_m = 17, to_m = 2;          ///< Before the plant's front, at 2.5 m/s.
};
/// Registration by lidar odometry: 2 cm and 0.1°.
inline constexpr ApproachOptions kOdometry{0.026, 0.03, 0.02, 0.0017};
/// A vehicle on a floor.
inline constexpr ApproachOptions kSmooth{0, 0, 0, 0};

/// The beams that two sensors on an approaching vehicle send towards the plant, the upper one a
/// metre above and 1.4 m behind the lower one. `quick`: every eighth scan.
BeamLog approach_beams(const test_site::PlantMesh& plant, bool quick, const ApproachOptions& options);
/// The beams answered by the plant, with footprint, σ and resolution of their sensor.
struct RangingOptions {
  std::optional<double> sigma_m;  ///< Noise of the range; none: the sensor's.
  int sub_rays = 9;
};
BeamLog approach_scan(const test_site::PlantMesh& plant, const BeamLog& beams, uint64_t seed,
                      const RangingOptions& ranging = {});
/// Of all hits, as registered.
std::vector<Vec3f> registered(const BeamLog& log, const ApproachOptions& options, uint64_t seed);

/// One plant, or the ellipsoids fitted to a scan of one.
struct PlantFigures {
  std::string name;
  size_t elements = 0;  ///< Triangles or ellipsoids.
  size_t bytes = 0;     ///< Of vertices and triangles, or of the ellipsoids.
  bool crude = false;
  metrics::LeafInclination leaves;     ///< With the poses known exactly, as a simulator knows them.
  metrics::LeafInclination displaced;  ///< With errors of registration.
};
PlantFigures figures_of(const SweepPlant& plant, const BeamLog& scan, uint64_t seed);
/// Fits ellipsoids to `scan` and scores what they answer to the same beams.
PlantFigures ellipsoids_of(const BeamLog& scan, uint64_t seed);

/// Points drawn evenly from the surface: what there is to see, without a lidar.
std::vector<Vec3f> surface_points(const test_site::PlantMesh& plant, size_t n, uint64_t seed);

/// The thresholds: all boards and all cartoons outside ε ≤ 0.11, the finest plant inside, ε falls
/// with ln n.
std::vector<Check> sweep_checks(const std::vector<PlantFigures>& plants,
                                const metrics::LogRegression& line);

/// The score of one plant with and without what shapes its cloud.
void add_conditions(const StudyRun& run, const SweepPlant& plant, StudyResult& result);

/// The scores of one plant of each kind by other sensors, from a whole approach and one scan.
void add_sensors(const StudyRun& run, const std::vector<SweepPlant>& plants, StudyResult& result);

/// A score as JSON, and as cells: points, μ, σ, ε, inside or outside.
Json json_of(const metrics::LeafInclination& l);
std::vector<std::string> cells(const metrics::LeafInclination& l);

/// The real clouds of `run.data`: vegetation of logs, and point files as they are.
void add_real_vegetation(const StudyRun& run, StudyResult& result);

}  // namespace underbrush::studies
