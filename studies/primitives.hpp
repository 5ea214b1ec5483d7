/// The pieces of the primitives study: protocol of [tallavajhula18] §V.
#pragma once
#include <map>
#include <span>

#include "studies/study.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/primitives/compose.hpp"
#include "underbrush/primitives/mesh_primitives.hpp"

namespace underbrush::studies {

/// Logs of two sites, or of two stretches of one, labelled: columns `class` and `instance`.
struct SitePair {
  std::string name;
  BeamLog train, test;
  double min_range_m = 0;  ///< Nearer returns are of the vehicle that carries the sensor.
  bool one_site = false;   ///< Primitives that the test's sensor could see are left out.
};

/// A set of mesh primitives, and what its row is called.
struct MeshSet {
  std::string name;
  std::filesystem::path folder;
};

/// What a study does with a pair.
struct PairOptions {
  uint64_t seed = 1;
  std::vector<MeshSet> meshes;  ///< At least one; the first is the verdict's.
  std::filesystem::path work;   ///< Folder for the primitives cut; replaced.
  bool pictures = false;
  /// Changes the primitives before they are composed: so that tests can break them.
  std::function<void(std::vector<primitives::Primitive>&)> change = {};
};

/// What came of it.
struct PairOutcome {
  std::string name;
  /// Of the table: primitives, the sets of meshes, geospecific, replay.
  std::vector<std::string> rows;
  std::map<std::string, metrics::Score> score;  ///< By row.
  size_t train_beams = 0, test_beams = 0;
  size_t primitives = 0, seen_by_both = 0, objects = 0, left_out = 0;
  std::vector<double> box_distance_m;  ///< Of the rows that are composed.
  std::string pictures;
};

/// Fits to `train`, extracts, annotates `test`, composes with the primitives and each set of
/// meshes, fits `test` itself, replays `train`; answers the beams of `test` with each and scores.
PairOutcome run_pair(const SitePair& pair, const PairOptions& options);

/// The beams of `test`, each answered by what the scan of `train` whose sensor stood nearest saw in
/// the same ring at the nearest azimuth of the sensor's frame.
BeamLog replay(const BeamLog& train, const BeamLog& test);

/// Adds the columns `class` and `instance` as `segment` does.
void label_log(BeamLog& log, double min_range_m);

/// Two stretches of a drive by the numbers of their scans.
struct StretchPair {
  std::string name;
  std::vector<uint32_t> train, test;
};
/// All pairs of a stretch of `train_m` and one of `test_m` along the path of the sensor, both
/// begun every `test_m`, whose poses are all at least `apart_m` from each other.
std::vector<StretchPair> stretch_pairs(std::span<const ScanInfo> scans, double train_m,
                                       double test_m, double apart_m);

/// Pairs of stretches of the folder's log.ply that are 100 m apart; says why where there are none.
std::vector<StretchPair> pairs_of_drive(const std::filesystem::path& log);
SitePair read_stretches(const std::filesystem::path& log, const StretchPair& stretches);

/// Two generated sites, with their true labels.
SitePair generated_pair(uint64_t train_seed, uint64_t test_seed, bool quick);

/// Mean and standard deviation, and how far the 95 % confidence interval of the mean reaches to
/// either side (Student's t); the latter two are NaN for fewer than two values.
struct Spread {
  double mean = 0, sd = 0, reach = 0;
};
Spread spread_of(std::span<const double> values);

/// By how much the primitives beat the first set of meshes: more than the paper's margins (0.07 m
/// of cloud error, 0.21 m of packet error, 0.03 of F1), on average or, `confident`, at the lower
/// end of the 95 % interval of the mean difference.
std::vector<Check> primitive_checks(const std::string& where, std::span<const PairOutcome> outcomes,
                                    bool confident);

/// Adds tables, figures, checks and pictures; of a table's figures ± is the reach of the 95 %
/// interval of the mean if `confident`, else the standard deviation.
void add_outcomes(const std::string& where, const std::vector<PairOutcome>& outcomes,
                  bool confident, StudyResult& result);

/// Pictures like Fig. 8 to 10.
struct Composed {
  std::string name;
  const primitives::PrimitiveSet* set;
  const elements::Scene* scene;
  const BeamLog* log;
};
std::string primitive_pictures(const std::string& name, const BeamLog& test,
                               std::span<const Composed> composed);

}  // namespace underbrush::studies
