/// \file
/// Scores of the intensities of simulated returns.
#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::metrics {

/// Errors of predicted intensities, in the unit of the logs; NaN without data.
struct IntensityErrors {
  size_t beams = 0;
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mae = std::numeric_limits<double>::quiet_NaN();
  /// Pearson's correlation; NaN where one side is constant.
  double correlation = std::numeric_limits<double>::quiet_NaN();
};

/// The scores of intensities over the beams that return in both logs.
struct IntensityScore {
  IntensityErrors simulated;
  /// Errors of a constant prediction: the mean of all real returns. No constant has a smaller RMSE,
  /// because the mean is that of the log which is scored.
  IntensityErrors constant;
  /// Errors of a constant prediction for each class or kind of element: the mean of its real
  /// returns.
  IntensityErrors group_constant;
  /// "class" if the real log has classes, else "kind" if there is a model, else empty.
  std::string groups;
  double real_mean = 0, real_sd = 0, simulated_mean = 0, simulated_sd = 0;
  /// First Wasserstein distance of the two distributions: the mean difference of the sorted
  /// intensities, which ignores the assignment to beams.
  double wasserstein = 0;
  std::map<std::string, IntensityErrors> per_range;  ///< By real range, "0-10" and so on, m.
  /// By the angle of incidence (`elements::incidence_cosine`) on the element that explains the real
  /// return, "0-30" and so on, degrees; empty without a model.
  std::map<std::string, IntensityErrors> per_incidence;
};

/// The name of the bin from `edges[k]` to the next edge; the last bin has no end.
std::string bin_name(const std::vector<double>& edges, size_t k);

/// Collects the beams that return in both logs, which takes 16 bytes each.
class IntensityScorer {
 public:
  /// `model` is null or the world of one model, which must outlive this. `range_edges_m` rise.
  IntensityScorer(std::vector<double> range_edges_m, const trace::World* model)
      : range_edges_m_(std::move(range_edges_m)), model_(model) {}
  /// Replaces the world of one model by another part of it.
  void use(const trace::World& part) { model_ = &part; }
  /// Adds the same beams of both logs. Returns with the flag `kMover` are left out.
  void add(const BeamLog& real, const BeamLog& simulated);
  /// Computes the scores. There are no scores where all intensities of one side are 0; `why` then
  /// names the side.
  std::optional<IntensityScore> finish(std::string& why) const;

 private:
  struct Pair {
    float real = 0, simulated = 0;
    uint8_t range_bin = 0, incidence_bin = 0;  // kNoBin: none
    uint32_t group = 0;
  };
  std::vector<double> range_edges_m_;
  const trace::World* model_;
  std::vector<Pair> pairs_;
  bool has_classes_ = false;
};

}  // namespace underbrush::metrics
