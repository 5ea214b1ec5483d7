/// \file
/// This file has the rules by which an object enters a list and leaves it again.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// The rule by which an object is listed.
enum class ExistenceRule : uint8_t {
  kProbability,  ///< The existence probability of a listed object reaches a threshold.
  kInARow,       ///< After so many cycles in a row with points; until so many without.
  kOutOf,        ///< After so many cycles with points in a window; until so many without.
};

/// The changes of the existence probability, and the points that an object needs to begin.
struct ExistenceStep {
  double gain = 0.2;          ///< Increase by a cycle with enough points.
  double loss = 0.055;        ///< Decrease by any other cycle.
  uint32_t start_points = 3;  ///< An object that is not listed needs more points than these.
};

/// The options of `Existence`. The defaults are those that the authors of [rosenberger20]
/// published: an object is confirmed in the third cycle, and one of probability 1 that is hidden
/// stays for nine cycles and is dropped in the tenth.
struct ExistenceOptions {
  ExistenceRule rule = ExistenceRule::kProbability;
  ExistenceStep step;
  /// Replaces `step` for objects of a class.
  std::array<std::optional<ExistenceStep>, kClassCount> by_class{};
  double threshold = 0.5;    ///< The probability at which an object is listed.
  uint32_t keep_points = 0;  ///< A listed object needs more points than these.
  /// m; the gain of a segment whose horizontal extent is smaller is reduced in proportion; 0 =
  /// never.
  double full_extent_m = 0;
  int needed = 5;   ///< Cycles with points that `kInARow` and `kOutOf` require.
  int window = 10;  ///< Cycles in the window of `kOutOf`; at most 32.
  int lost = 10;    ///< Cycles in a row without points after which these two rules drop an object.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// The existence of one object over time, [rosenberger20] §3.3.
class Existence {
 public:
  /// Counts a cycle with so many points, in a segment of so much horizontal extent.
  void update(const ExistenceOptions& options, ObjectClass label, uint32_t points, double extent_m);

  double probability() const { return probability_; }
  bool is_listed() const { return listed_; }
  /// Whether the object was dropped or never confirmed, so that it can be forgotten. Should it come
  /// back, it is confirmed anew.
  bool is_gone(const ExistenceOptions& options) const;

 private:
  bool follows(const ExistenceOptions& options) const;

  double probability_ = 0;
  uint32_t seen_ = 0;  ///< A bit for each cycle, the last one lowest.
  int missed_ = 0;     ///< Cycles in a row without enough points.
  bool listed_ = false;
  bool was_listed_ = false;
};

}  // namespace underbrush::perception
