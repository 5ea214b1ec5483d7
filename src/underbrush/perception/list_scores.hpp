/// \file
/// This file compares two lists of objects over time.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "underbrush/perception/hota.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// The options of the comparison.
struct ListScoreOptions {
  double gate_m = 3;          ///< m; centres farther apart (x, y) are not of one object.
  double tolerance_s = 0.05;  ///< Lists whose times differ by more do not belong together.
  double bin_m = 10;          ///< m; bins of the detection rate by range.
  double ospa_cutoff_m = 10;  ///< m; cost of a missing or superfluous object.
  double ospa_order = 1;
  double hota_zero_m = 2;  ///< m; the distance at which two objects have no similarity for HOTA.
  /// Whether objects that the reference does not have are left out, because it is not complete.
  bool ignore_unmatched = false;
};

/// An object of the reference at one time, and its counterpart in the other list.
struct Moment {
  double time_s = 0;
  double range_m = 0;  ///< From the vehicle to the centre, x and y.
  TrackedObject reference;
  std::optional<TrackedObject> found;
};

/// An object of the reference over time.
struct FollowedObject {
  uint64_t id = 0;
  ObjectClass label = ObjectClass::kUnknown;
  std::vector<Moment> moments;
};

/// Objects of the reference in a range bin, and the number of them in the other list.
struct RangeBin {
  double from_m = 0;
  size_t objects = 0, found = 0;
};

/// The scores of a list against a reference.
struct ListScore {
  size_t cycles = 0;     ///< Cycles that both have.
  size_t objects = 0;    ///< Objects of the reference, over all cycles.
  size_t found = 0;      ///< Number of these that the list has.
  size_t unmatched = 0;  ///< Objects of the list that the reference does not have.
  size_t switches = 0;   ///< Times that an object has another id than when it was last found.
  double position_mean_m = 0, position_rms_m = 0;  ///< Error of the centre, x and y, where found.
  double yaw_mean_rad = 0;                         ///< Mean absolute error modulo a half turn.
  double ospa_m = 0;                               ///< Mean over the cycles [schuhmacher08].
  Hota hota;
  std::vector<RangeBin> by_range;
  std::vector<FollowedObject> followed;  ///< In order of id.
};

/// Compares a list with a reference. Objects are assigned in each cycle by the least sum of
/// distances of their centres. OSPA is ((Σ d^p + c^p (n − m)) / n)^(1/p) for m and n ≥ m objects.
ListScore score_lists(std::span<const ObjectList> lists, std::span<const ObjectList> reference,
                      const ListScoreOptions& options = {});

/// The compared values: x, y, z, length, width, height.
inline constexpr std::array<const char*, 6> kComparedValues{"x",      "y",     "z",
                                                            "length", "width", "height"};

/// The root mean squared differences of the values of one object between two lists.
struct ValueErrors {
  size_t cycles = 0;  ///< Cycles in which both have the object.
  std::array<double, 6> rmse_m{};
  /// `rmse_m` over the absolute value of the truth at the first time step of the run.
  std::array<double, 6> normalised{};
};

/// A row of [rosenberger20] Table 1.
struct ComparedObject {
  uint64_t id = 0;
  ObjectClass label = ObjectClass::kUnknown;
  ValueErrors simulated_real, simulated_truth, real_truth;
};

/// Compares simulated and real lists with each other and with the truth, [rosenberger20] §4.2: for
/// each value v of an object, RMSE(v_i, v_j) / v_GT,1. Positions are in the vehicle's frame of the
/// truth's first list. Objects that no pair has are left out.
std::vector<ComparedObject> compare_lists(std::span<const ObjectList> simulated,
                                          std::span<const ObjectList> real,
                                          std::span<const ObjectList> truth,
                                          const ListScoreOptions& options = {});

}  // namespace underbrush::perception
