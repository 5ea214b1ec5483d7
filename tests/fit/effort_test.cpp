#include "underbrush/fit/effort.hpp"

#include <gtest/gtest.h>

#include "underbrush/fit/part_options.hpp"

namespace underbrush::fit {
namespace {

TEST(Effort, SaysHowMuchOfALongLogTheStepsUse) {
  const auto beams_of = [](std::string_view name) {
    FitOptions options;
    options.effort = name;
    const likelihood::LikelihoodOptions steps = likelihood_options(options);
    double beams = 0;
    for (int round = 0; round < steps.rounds; ++round) {
      beams += 1.0 / likelihood::share_of_round(2 * credit::kLongLog, round, steps).weight();
    }
    return beams;
  };
  EXPECT_EQ(effort_names(), (std::vector<std::string_view>{"low", "medium", "high"}));
  EXPECT_EQ(FitOptions().effort, "medium");
  EXPECT_EQ(beams_of("low"), 1);
  EXPECT_EQ(beams_of("medium"), 2);
  EXPECT_EQ(beams_of("high"), 5);
  EXPECT_THROW(effort_named("extreme"), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::fit
