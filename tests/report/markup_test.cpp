#include "report/markup.hpp"

#include <gtest/gtest.h>

namespace underbrush::report {
namespace {

TEST(Markup, TextIsEscaped) {
  EXPECT_EQ(escaped("a<b & \"c\">"), "a&lt;b &amp; &quot;c&quot;&gt;");
}

TEST(Markup, StepsAreOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(round_step_above(0.011), 0.02);
  EXPECT_DOUBLE_EQ(round_step_above(2), 2);
  EXPECT_DOUBLE_EQ(round_step_above(5.1), 10);
  EXPECT_DOUBLE_EQ(round_step_below(0.019), 0.01);
  EXPECT_DOUBLE_EQ(round_step_below(49), 20);
  EXPECT_DOUBLE_EQ(round_step_below(50), 50);
}

}  // namespace
}  // namespace underbrush::report
