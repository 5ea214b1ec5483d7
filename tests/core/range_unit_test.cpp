#include "underbrush/core/range_unit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush {
namespace {

/// Beams of ranges from `least_m` to four times that, whose directions have this vertical part.
BeamLog log_of(double least_m, double steepness) {
  BeamLog log;
  log.resize(1000);
  for (size_t i = 0; i < log.size(); ++i) {
    log.range_m[i] = float(least_m * (1 + 3 * double(i) / double(log.size())));
    log.direction[i] = Vec3f(float(std::sqrt(1 - steepness * steepness)), 0, -float(steepness));
  }
  return log;
}

bool in_mm(const BeamLog& log) {
  MemorySource source(log);
  try {
    require_metres(source, "fit");
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("fit: half of the returns"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("--unit mm"), std::string::npos);
    return true;
  }
  return false;
}

TEST(RangeUnit, MillimetresAreFarAndLevel) {
  for (const double range : {4.0, 15.0, 60.0}) {
    EXPECT_FALSE(in_mm(log_of(range, 0.1)));
    EXPECT_TRUE(in_mm(log_of(1000 * range, 0.1)));
  }
  EXPECT_FALSE(in_mm(log_of(1500, 0.1)));  // m, over a valley
  EXPECT_FALSE(in_mm(log_of(3000, 0.9)));  // m, from the air
  EXPECT_TRUE(in_mm(log_of(400e3, 0.9)));
  EXPECT_FALSE(in_mm(BeamLog()));
}

}  // namespace
}  // namespace underbrush
