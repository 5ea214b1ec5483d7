#include "underbrush/optimize/fit_parameters.hpp"

#include <gtest/gtest.h>

#include <set>

#include "underbrush/fit/parameters.hpp"

namespace underbrush::optimize {
namespace {

TEST(FitParameters, AreSetEachForItself) {
  for (const std::string& fitter : fit::fitter_names()) {
    fit::FitOptions options;
    options.fitter = fitter;
    const std::vector<FitParameter> all = fit_parameters(options);
    std::set<std::string> names;
    for (const FitParameter& p : all) {
      EXPECT_TRUE(names.insert(p.name).second) << fitter << " " << p.name;
      EXPECT_TRUE(number_of(*p.of, options) >= p.low && number_of(*p.of, options) <= p.high)
          << "the default is outside its range: " << fitter << " " << p.name;
      EXPECT_TRUE(p.low >= p.of->least && p.high <= p.of->most)
          << "the range leaves the limits: " << fitter << " " << p.name;
      fit::FitOptions changed = options;
      const double value = value_at(p, 0.9);
      set_number(*p.of, changed, value);
      EXPECT_EQ(number_of(*p.of, changed), value) << p.name;
      for (const FitParameter& other : all) {
        if (other.name == p.name) continue;
        EXPECT_EQ(number_of(*other.of, changed), number_of(*other.of, options))
            << p.name << " " << other.name;
      }
    }
  }
}

TEST(FitParameters, OfThePaperAreAmongTheUsualOnes) {
  std::set<std::string> usual;
  for (const FitParameter& p : chosen_fit_parameters({}, {})) usual.insert(p.name);
  for (const char* name : {"clusters-per-point", "tau", "max-residual-for-hit", "min-points"}) {
    EXPECT_TRUE(usual.count(name)) << name;
  }
  EXPECT_FALSE(usual.count("range-noise"));
}

TEST(FitParameters, AreChosenByName) {
  const std::string names[] = {"range-noise", "tau"};
  const std::vector<FitParameter> two = chosen_fit_parameters({}, names);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].name, "range-noise");
  const std::string of_another[] = {"voxel-side"};
  EXPECT_THROW(chosen_fit_parameters({}, of_another), std::invalid_argument);
  fit::FitOptions refined;
  refined.fitter = "likelihood";
  refined.start = "voxel";
  EXPECT_EQ(chosen_fit_parameters(refined, of_another).size(), 1u);
}

}  // namespace
}  // namespace underbrush::optimize
