/// \file
/// This file scores lists of objects over time by detection and association at once.
#pragma once
#include <array>
#include <cstddef>
#include <map>
#include <vector>

#include "underbrush/perception/assignment.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// The higher order tracking accuracy [luiten21]; each value lies between 0 and 1.
struct Hota {
  double hota = 0;         ///< Mean over the thresholds of √(detection · association).
  double detection = 0;    ///< Mean share of the objects of either list that both have.
  double association = 0;  ///< Mean agreement of the numbers of matched objects.
};

/// Counts the objects of cycles for `Hota`.
///
/// The similarity of two objects is 1 − d / `zero_m` for the distance d of their centres (x, y). A
/// pair counts from each of the thresholds 0.05, 0.1 ... 0.95 on. Pairs are chosen in each cycle by
/// the greatest sum of similarities times the agreement of the two numbers over all cycles
/// [luiten21].
class HotaCounts {
 public:
  explicit HotaCounts(double zero_m) : zero_m_(zero_m) {}
  /// Adds a cycle. With `ignore_unmatched`, objects of the list that no object of the reference is
  /// similar to are left out.
  void add(const ObjectList& reference, const ObjectList& list, bool ignore_unmatched);
  /// The values of all cycles that were added.
  Hota result() const;

 private:
  static constexpr size_t kThresholds = 19;
  using Counts = std::vector<std::map<size_t, double>>;  ///< By numbers of both lists.

  // A cycle: the numbers of its objects, counted from 0, and their similarities row by row.
  struct Cycle {
    std::vector<size_t> reference, list;
    std::vector<double> similarity;
  };

  double agreement(size_t reference, size_t list, double together) const;

  double zero_m_;
  std::map<uint64_t, size_t> reference_ids_, list_ids_;
  std::vector<double> reference_cycles_, list_cycles_;  ///< Cycles that have a number.
  Counts likely_;  ///< Similarities, as shares of those of their rows and columns.
  std::vector<Cycle> cycles_;
};

}  // namespace underbrush::perception
