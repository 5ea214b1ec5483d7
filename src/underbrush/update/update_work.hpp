/// \file
/// The steps of one update of a model.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/credit/crossing_beams.hpp"
#include "underbrush/credit/mesh_noise.hpp"
#include "underbrush/fit/gather.hpp"
#include "underbrush/update/change.hpp"
#include "underbrush/update/update_report.hpp"

namespace underbrush::update {

/// The work of one update, step by step. All arguments of the constructor must outlive it.
class UpdateWork {
 public:
  /// Changes `out` and `report`. `logs` are those of the model, `added` the new scans.
  UpdateWork(fit::FitResult& out, UpdateReport& report, const std::vector<BeamSource*>& logs,
             BeamSource& added, const fit::FitOptions& options, const fit::FitProgress& progress);

  /// Fits some tiles anew, to the points of all logs.
  void fit(const std::vector<TileKey>& anew);
  /// Counts the hits and misses of all elements, and drops ellipsoids in free space.
  void count();
  /// Refines new elements and the ground of fitted tiles as `likelihood` does, with the beams that
  /// may meet them. Earlier beams through changed ellipsoids are left out.
  void refine_new(const likelihood::LikelihoodOptions& options);
  /// Learns the classes and the reflectances of new elements.
  void colour();
  /// After `count`, the earlier state of the ellipsoids that later beams contradict.
  const elements::Model& changed() const { return changed_; }

 private:
  void gather_near(BeamSource& log, const fit::TileSet& wanted, TileStore& store);
  /// Calls `use` with the new beams and those of the earlier logs that may meet new elements, but
  /// none of the ellipsoids of `changed` if that is not null.
  void with_crossing(const std::function<void(BeamSource&)>& use,
                     const elements::Model* changed = nullptr) const;
  credit::GroundArea area_now() const;
  BeamSource* crossing_of(BeamSource& log, const credit::GroundArea& area,
                          std::vector<std::unique_ptr<BeamSource>>& hold) const;
  /// Adds the trials of one more log. Triangles are opaque and do not go.
  void add_log(const std::vector<credit::Trials>& later, std::vector<CurrentTrials>& now) const;
  /// Counts the beams of the earlier logs for the elements that are new.
  void count_earlier(const trace::World& world, std::vector<CurrentTrials>& now);
  /// Adds the times of the trials of one more log, of the ellipsoids that are new.
  void add_times(const credit::Tally& tally);
  /// Learns the noise of the ground from all residuals. A refined ground keeps its own.
  void learn_noise(credit::MeshResiduals& residuals);
  void take_over_light(const std::vector<uint32_t>& triangles);
  /// The hit probabilities of the ellipsoids by their counts.
  std::vector<double> hit_probabilities() const;
  /// Whether an ellipsoid with a density has the counts that it had before.
  bool is_untouched(const elements::Ellipsoid& before, const elements::Ellipsoid& now) const;
  /// The optical depth −ln(1 − p) of a kept ellipsoid that has changed does so as that of its
  /// counts.
  void adapt_densities(const std::vector<elements::Ellipsoid>& before,
                       const std::vector<double>& p_before, std::span<const CurrentTrials> now);
  void drop(const std::vector<elements::Ellipsoid>& before, std::span<const CurrentTrials> now);
  fit::FitResult& out_;
  elements::Model& model_;
  UpdateReport& report_;
  const std::vector<BeamSource*>& logs_;
  BeamSource& added_;
  const fit::FitOptions& options_;
  const fit::FitProgress& progress_;
  const elements::TriangleMesh ground_;  // as it was
  std::vector<TileKey> anew_;
  std::vector<uint32_t> before_;           // of each ellipsoid, its number in the model as it was
  std::vector<bool> new_;                  // of each element, whether it is new
  elements::Model changed_;                // the ellipsoids that later beams contradict
  std::vector<credit::TrialTimes> times_;  // of the ellipsoids that are new
  std::optional<double> zero_s_;           // the time from which they count
  size_t ellipsoids_ = 0, traced_ = 0;
};

}  // namespace underbrush::update
