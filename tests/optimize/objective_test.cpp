#include "underbrush/optimize/objective.hpp"

#include <gtest/gtest.h>

namespace underbrush::optimize {
namespace {

TEST(Objective, IsPacketErrorAndTwiceWhatF1Lacks) {
  metrics::Summary s;
  s.packet_error_m = 2.9;
  s.f1 = 0.68;
  EXPECT_DOUBLE_EQ(objective_of("packet_f1", s, 80), 2.9 + 2 * 0.32);
  s.nll_per_beam = 1.25;
  EXPECT_EQ(objective_of("nll", s, 80), 1.25);
}

TEST(Objective, IsFiniteAndWorstWhereNothingIsReturnedByBoth) {
  const metrics::Summary s;  // all scores are unknown
  EXPECT_EQ(objective_of("packet_f1", s, 80), 82);
  EXPECT_THROW(objective_of("nll", s, 80), std::invalid_argument);
  EXPECT_THROW(objective_of("chamfer", s, 80), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::optimize
