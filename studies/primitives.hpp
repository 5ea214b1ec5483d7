/// The parts of the primitives study, which follows the protocol of [tallavajhula18] §V.
#pragma once
#include <map>
#include <span>

#include "studies/study.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/pipeline/extract_primitives.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/plant_meshes/mesh_primitives.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::studies {

/// Labelled logs (columns `class` and `instance`) of two sites, or of two stretches of one.
struct SitePair {
  std::string name;
  BeamLog train, test;
  double min_range_m = 0;  ///< Nearer returns are of the vehicle that carries the sensor.
  /// Whether both logs are of one site. Then primitives within the range of a pose of the test are
  /// left out, and those that share ground with an object of its annotation (`leave_out`).
  bool one_site = false;
};

/// The test site without the elements of its plants.
struct AnnotatedSite {
  elements::Model ground;
  primitives::Annotation annotation;
};
/// Returns the ground and the objects of a labelled log, as `annotate` does. The site reaches as
/// far as `max_range_m`.
AnnotatedSite annotated_site(const BeamLog& test, double max_range_m);

/// Fits a model to a log, with the defaults of `fit`.
elements::Model fit_of_log(const BeamLog& log, double min_range_m, uint64_t seed);
/// Simulates the beams of a log, with the defaults of `simulate`.
BeamLog answers_of_world(const pipeline::TracedWorld& world, const BeamLog& beams, uint64_t seed);
/// Scores a simulated log.
metrics::Score scores_of(const BeamLog& real, const BeamLog& simulated);

/// The primitives of a training log, and the numbers of those left out.
struct CutPrimitives {
  std::vector<primitives::Primitive> primitives;
  size_t seen_by_both = 0;   ///< Primitives within the range of a pose of the test.
  size_t shared_plants = 0;  ///< Primitives that share ground with an object of the test site.
};
/// Extracts the primitives of the training log from the model that was fitted to it. Where both
/// logs are of one site, those near the test are left out (`SitePair::one_site`).
CutPrimitives cut_primitives(const SitePair& pair, const elements::Model& trained,
                             const AnnotatedSite& site,
                             const pipeline::ExtractOptions& options = {});

/// A set of mesh primitives, and the name of its row.
struct MeshSet {
  std::string name;
  std::filesystem::path folder;
  bool adapted = true;  ///< Whether `adaptable_meshes` comes before the composition.
};
/// Returns a set of mesh primitives with the layers of points drawn evenly over the surface of
/// each, so that `compose` adapts them to the objects as it adapts primitives that are cut from
/// logs.
primitives::PrimitiveSet adaptable_meshes(primitives::PrimitiveSet set);

/// Options of `run_pair`.
struct PairOptions {
  uint64_t seed = 1;
  std::vector<MeshSet> meshes;  ///< At least one; the verdict uses the first.
  bool pictures = false;
  /// Changes the primitives before they are composed, so that tests can break them.
  std::function<void(std::vector<primitives::Primitive>&)> change = {};
};

/// The result of `run_pair`.
struct PairOutcome {
  std::string name;
  /// Rows of the table: primitives, the sets of meshes, geospecific, replay, always hit.
  std::vector<std::string> rows;
  std::map<std::string, metrics::Score> score;  ///< The scores by row.
  size_t train_beams = 0, test_beams = 0;
  size_t primitives = 0, seen_by_both = 0, shared_plants = 0, objects = 0, left_out = 0;
  std::vector<double> box_distance_m;  ///< m; one for each row that is composed.
  std::string pictures;
};

/// Runs the protocol on a pair: fits a model to `train`, extracts primitives, annotates `test`,
/// composes scenes with the primitives and with each set of meshes, fits `test` itself, replays
/// `train`, and always hits at the median ranges of its rings. Simulates the beams of `test` with
/// each of these and scores them.
PairOutcome run_pair(const SitePair& pair, const PairOptions& options);

/// Answers each beam of `test` with a measurement of the scan of `train` whose sensor stood
/// nearest, the one of the same ring at the nearest azimuth in the sensor's frame.
BeamLog replay(const BeamLog& train, const BeamLog& test);

/// Adds the columns `class` and `instance` as `segment` does.
void label_log(BeamLog& log, double min_range_m);

/// Two stretches of a drive, by the numbers of their scans.
struct StretchPair {
  std::string name;
  std::vector<uint32_t> train, test;
};
/// Returns all pairs of a stretch of `train_m` and one of `test_m` along the sensor's path that
/// begin at multiples of `test_m` and whose poses are all at least `apart_m` from each other (m).
std::vector<StretchPair> stretch_pairs(std::span<const ScanInfo> scans, double train_m,
                                       double test_m, double apart_m);

/// Returns the files log.ply of the folders of `data`, in order of name; none for an empty path.
std::vector<std::filesystem::path> drives_of(const std::filesystem::path& data);
/// Returns the pairs of stretches of a drive's log that are 100 m apart; empty if there are none.
std::vector<StretchPair> pairs_of_drive(const std::filesystem::path& log);
/// Reads the two stretches of a log.
SitePair read_stretches(const std::filesystem::path& log, const StretchPair& stretches);

/// Returns the logs of two generated sites, with their true labels.
SitePair generated_pair(uint64_t train_seed, uint64_t test_seed, bool quick);

/// Mean, standard deviation, and half the 95 % confidence interval of the mean (Student's t). The
/// latter two are NaN for fewer than two values.
struct Spread {
  double mean = 0, sd = 0, reach = 0;
};
/// Returns the spread of some values.
Spread spread_of(std::span<const double> values);

/// Returns the checks that the primitives beat the first set of meshes by the paper's margins (0.07
/// m of cloud error, 0.21 m of packet error, 0.03 of F1). The difference counts on average or, if
/// `confident`, at the lower end of the 95 % interval of its mean.
std::vector<Check> primitive_checks(const std::string& where, std::span<const PairOutcome> outcomes,
                                    bool confident);

/// Adds tables, figures, checks and pictures. In a table ± is half the 95 % interval of the mean if
/// `confident`, else the standard deviation.
void add_outcomes(const std::string& where, const std::vector<PairOutcome>& outcomes,
                  bool confident, StudyResult& result);

/// A composed scene and its simulated log, for the pictures.
struct Composed {
  std::string name;
  const primitives::PrimitiveSet* set;
  const elements::Scene* scene;
  const BeamLog* log;
};
/// Returns pictures like Fig. 8 to 10 of [tallavajhula18] as HTML.
std::string primitive_pictures(const std::string& name, const BeamLog& test,
                               std::span<const Composed> composed);

}  // namespace underbrush::studies
