/// The parts of the study of [deschaud12]: its Table I on generated targets, and its mobile
/// experiment.
#pragma once
#include <functional>
#include <map>

#include "studies/static_scan.hpp"
#include "studies/study.hpp"
#include "underbrush/fit/fit_options.hpp"

namespace underbrush::studies {

/// A way to model and simulate vegetation.
struct Contender {
  std::string name;
  fit::FitOptions fit;
  bool random_ray = false;  ///< Whether rays are drawn from the beam's cone instead of lying on its
                            ///< axis.
  /// Whether matter is drawn once, as `simulate` does by default, or anew for each beam, as
  /// [deschaud12] does.
  bool once = false;
};

/// The name of the contender that the verdict is about: `simulate` with its defaults.
inline constexpr const char* kDefault = "default";

/// Returns the contenders for the static targets, of which the first is `kDefault`. The surface and
/// the voxels of [deschaud12] are there twice, with both kinds of rays.
std::vector<Contender> static_contenders(uint64_t seed);
/// Returns the contenders for the mobile experiment, of which the first is `kDefault`.
std::vector<Contender> mobile_contenders(uint64_t seed);
/// Whether a contender models vegetation as a surface.
bool is_surface(const Contender& contender);

/// The score of one contender on one target.
struct StaticScore {
  double distance = 0;        ///< Bhattacharyya distance between simulation and measurement.
  double mean_of_lasers = 0;  ///< Mean of the distances of each laser's own histogram.
  size_t elements = 0;
  double fit_seconds = 0;
};

/// The scores of all contenders on one target.
struct TargetScores {
  std::string target;
  bool porous = true;
  size_t directions = 0, train_beams = 0, test_beams = 0;
  /// Distances of "look-up", the training fifth itself, and of "always hit", the median range of
  /// each laser in it.
  std::map<std::string, double> baselines;
  std::map<std::string, StaticScore> scores;  ///< By contender.
};

/// Returns the thresholds of Table I for `kDefault`: its distance is at most 0.02 on the planes; on
/// each porous target the ratio of the surface's distance (with the better of its rays) to its own
/// is at least the paper's factor.
std::vector<Check> static_checks(const std::vector<Contender>& contenders,
                                 const std::vector<TargetScores>& targets);

/// Scans, fits, simulates and scores the targets of these names (`static_target_names`). `change`,
/// for tests, alters each volumetric model before it is scored.
void add_static_targets(const StudyRun& run, const std::vector<std::string>& names,
                        StudyResult& result,
                        const std::function<void(elements::Model&)>& change = {});

/// Runs the mobile experiment on each folder of `run.data` that holds train.ply and test.ply.
void add_mobile_logs(const StudyRun& run, StudyResult& result);

/// A histogram and its name in the pictures.
struct NamedHistogram {
  std::string name;
  const metrics::BearingRangeHistogram* histogram;
};
/// Returns pictures of one target as HTML: the 2-D histograms of one laser and the 1-D histogram of
/// one beam, measured and simulated.
std::string histogram_figures(const std::string& target, const std::vector<NamedHistogram>& shown);

}  // namespace underbrush::studies
