/// \file
/// This file declares `update`, which adds new scans to a fitted model.
#pragma once
#include <vector>

#include "underbrush/fit/fit.hpp"
#include "underbrush/update/update_report.hpp"

namespace underbrush {
/// Adds new scans to fitted models.
namespace update {

/// The options of `update`.
struct UpdateOptions {
  /// A tile that new returns touch is fitted anew once its returns have grown by this share since
  /// it was fitted. With 0 every touched tile is fitted anew, and the elements are those of one fit
  /// of all scans, unless they are refined.
  double growth = 0.25;
  /// A tile is fitted anew, too, once this share of its returns lies where no element explains
  /// them.
  double unexplained = 0.01;
};

/// An updated model, its record, and the report.
struct UpdateResult {
  elements::Model model;
  fit::FitRecord record;
  UpdateReport report;
};

/// Adds the scans of `added` to a model that `fit` made of `logs` (in the order in which they were
/// added, the first being that of the fit) with `options`.
///
/// - Tiles that new returns touch enough (`UpdateOptions`) are fitted anew, to the points of all
///   logs. Other tiles keep their ellipsoids bit for bit. The ground mesh is solved again from the
///   sums of all tiles.
/// - Every element that new beams meet gets their hits and misses. New elements get those of the
///   earlier beams that cross the tiles fitted anew, too. If later beams contradict the earlier
///   beams of an ellipsoid, log by log, it keeps only the later trials (`add_trials`), and its
///   density, where it has one, changes with the optical depth of its counts. Ellipsoids in free
///   space are dropped as in `fit`.
/// - New ellipsoids of a refined model are refined among the others, which stay.
/// - Reflectances and classes of new elements are learnt from the same beams. The other
///   elements keep theirs, and the sensor's range offsets, its response to light and the grain
///   stay.
/// - Keyframes of the new scans are added to those of the model, whose pixels become unknown if
///   their beams met an ellipsoid that later beams contradict (`update_keyframes`).
///
/// The earlier logs are read only if a tile is fitted anew. The result has the same bits for any
/// number of threads. Without beams in `added` nothing changes. Throws `std::invalid_argument` for
/// options out of range, and `DataError` for a model without a record, scans of another sensor and
/// scans far away.
UpdateResult update(fit::FitResult known, const std::vector<BeamSource*>& logs, BeamSource& added,
                    const fit::FitOptions& options, const UpdateOptions& refitting = {},
                    const fit::FitProgress& progress = {});

}  // namespace update
}  // namespace underbrush
