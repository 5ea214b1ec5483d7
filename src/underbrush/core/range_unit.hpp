/// \file
/// Whether the ranges of a log are in metres.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush {

/// Returns of the beginning of a log, of which it is judged whether the log is in millimetres. It
/// is if half of them are farther than 10 km, or if half are farther than 1 km and a hundredth
/// farther than 10 km along beams that are level on the whole, as those of no survey from the air
/// are.
class RangeUnit {
 public:
  /// Takes the next beams of a log. Returns whether more are wanted.
  bool add(const BeamLog& beams);
  /// What is wrong with the log and what to do; "" if nothing is.
  std::string warning() const;

 private:
  size_t beams_ = 0;
  std::vector<float> range_m_, steepness_;  // steepness: of the direction, 0 to 1
};

/// Throws `DataError` for a log in millimetres, which calls the verb `verb`. Rewinds the log before
/// and after.
void require_metres(BeamSource& log, const std::string& verb);

}  // namespace underbrush
