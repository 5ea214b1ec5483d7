/// \file
/// Registration of the views of an actor, so that a model of many views is sharp.
#pragma once
#include <vector>

#include "underbrush/actors/actor_beams.hpp"

namespace underbrush::actors {

/// The options of `register_views`.
struct RegistrationOptions {
  int rounds = 20;          ///< Gauss–Newton steps of each view.
  double reach_m = 0.4;     ///< m; points of other views count up to this distance.
  double noise_m = 0.03;    ///< m; standard deviation of returns about a surface.
  double prior_m = 0.15;    ///< m; standard deviation of the given positions.
  double prior_rad = 0.05;  ///< rad; standard deviation of the given headings.
};

/// The agreement of the views of an actor.
struct RegistrationReport {
  /// m; median distance of returns from the surface through the returns of other views, before and
  /// after. Both are 0 where the views share no surface.
  double before_m = 0, after_m = 0;
};

/// Refines the poses of views: position and heading of each change until its returns lie on the
/// surfaces through the returns of the other views.
///
/// Each step takes, for every point, the plane through its up to eight nearest neighbours of other
/// views, and minimises the squared distances from the planes [chen92] with the weights of Geman
/// and McClure, together with the squared changes of the given poses in units of their standard
/// deviations. All views move at once, by half of their steps, because each meets the others
/// halfway. Only every n-th return of a view counts where it has more than 400.
RegistrationReport register_views(std::vector<View>& views,
                                  const RegistrationOptions& options = {});

}  // namespace underbrush::actors
