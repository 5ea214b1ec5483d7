#include "underbrush/pipeline/log_contents.hpp"

#include <gtest/gtest.h>

namespace underbrush::pipeline {
namespace {

// Half of the beams are of a car, half of an aircraft.
TEST(LogContents, RangesOfAircraftAreTold) {
  BeamLog log;
  log.resize(1000);
  for (size_t i = 0; i < log.size(); ++i) {
    log.range_m[i] = i % 2 ? 2300 + float(i) / 100 : 5 + float(i) / 100;
  }
  LogContents contents;
  contents.add(log);
  EXPECT_NEAR(contents.range_percentile(0.25), 10, 0.03);
  EXPECT_NEAR(contents.range_percentile(0.75), 2305, 1);
  log.range_m[0] = 1e6;
  log.range_m[1] = 999.999F;
  contents.add(log);
  EXPECT_NEAR(contents.range_percentile(1), 21000, 1);  // The last bin.
}

}  // namespace
}  // namespace underbrush::pipeline
