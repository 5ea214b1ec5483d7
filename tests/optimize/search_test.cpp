#include "underbrush/optimize/search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "underbrush/core/rng.hpp"

namespace underbrush::optimize {
namespace {

const std::vector<Parameter> kThree = {
    {"a", 0.01, 10, Scale::kLog}, {"b", -3, 5, Scale::kLinear}, {"c", 1, 100, Scale::kWhole}};
const std::vector<double> kStart = {5, -2, 80};

/// Computes a bowl over the places of the ranges with its bottom at a = 0.1, b = 1, c = 10. `rough`
/// adds noise that is a function of the values.
Outcome bowl(std::span<const double> v, double rough = 0) {
  const double x = std::log10(v[0] / 0.1), y = (v[1] - 1) / 4, z = std::log10(v[2] / 10);
  uint64_t bits = 7;
  for (const double one : v) bits = mix64(bits ^ uint64_t(std::llround(1e6 * one)));
  return {x * x + 2 * y * y + 0.5 * z * z + x * z / 4 + rough * uniform_from_bits(bits), {}};
}

std::vector<Evaluation> search_bowl(const SearchOptions& options, double rough = 0,
                                    const std::vector<Evaluation>& past = {},
                                    size_t* calls = nullptr) {
  return search(
      kThree, kStart, options,
      [&](std::span<const double> v) {
        if (calls) ++*calls;
        return bowl(v, rough);
      },
      past);
}

TEST(Parameter, ValuesAndPlacesAreInverse) {
  const std::vector<std::pair<Parameter, std::vector<double>>> cases = {
      {{"log", 0.005, 0.5, Scale::kLog}, {0.005, 0.1, 0.042, 0.5}},
      {{"linear", 0, 5, Scale::kLinear}, {0, 3, 3.5, 5}},
      {{"whole", 2, 30, Scale::kWhole}, {2, 3, 10, 30}}};
  for (const auto& [p, values] : cases) {
    EXPECT_EQ(value_at(p, -0.5), p.low);
    EXPECT_EQ(value_at(p, 1.5), p.high);
    for (const double v : values) EXPECT_EQ(value_at(p, place_of(p, v)), v) << p.name;
    for (double u = 0; u < 1; u += 0.01) EXPECT_LE(value_at(p, u), value_at(p, u + 0.01));
    EXPECT_EQ(place_of(p, 1e9), 1);
  }
  const Parameter log{"log", 0.01, 100, Scale::kLog};
  EXPECT_NEAR(value_at(log, 0.5), 1, 1e-12);
  EXPECT_EQ(value_at({"w", 1, 9, Scale::kWhole}, 0.45), std::round(std::pow(9, 0.45)));
}

TEST(Parameter, IsChosenByName) {
  EXPECT_EQ(chosen(kThree, {}), (std::vector<size_t>{0, 1, 2}));
  const std::string c[] = {"c", "a"};
  EXPECT_EQ(chosen(kThree, c), (std::vector<size_t>{2, 0}));
  const std::string unknown[] = {"zzz"}, twice[] = {"a", "a"};
  EXPECT_THROW(chosen(kThree, unknown), std::invalid_argument);
  EXPECT_THROW(chosen(kThree, twice), std::invalid_argument);
}

TEST(Search, FindsTheBottomOfABowlWithEveryAlgorithm) {
  for (const std::string& name : algorithms()) {
    const std::vector<Evaluation> tried = search_bowl({name, 120, 0.2});
    const Evaluation& best = tried[best_of(tried)];
    EXPECT_LT(best.outcome.objective, 0.01) << name;
    EXPECT_NEAR(std::log10(best.value[0]), -1, 0.15) << name;
    EXPECT_NEAR(best.value[1], 1, 0.5) << name;
  }
}

TEST(Search, KeepsItsBudgetAndItsRangesAndTriesNothingTwice) {
  for (const std::string& name : algorithms()) {
    for (const size_t budget : {1, 2, 5, 17, 60}) {
      size_t calls = 0;
      const std::vector<Evaluation> tried = search_bowl({name, budget, 0.2}, 0.1, {}, &calls);
      EXPECT_EQ(calls, tried.size());
      EXPECT_LE(tried.size(), budget);
      EXPECT_EQ(tried.front().value, kStart);
      std::set<std::vector<double>> values;
      for (const Evaluation& e : tried) {
        EXPECT_TRUE(values.insert(e.value).second);
        EXPECT_GE(e.outcome.objective, tried[best_of(tried)].outcome.objective);
        for (size_t k = 0; k < kThree.size(); ++k) {
          EXPECT_GE(e.value[k], kThree[k].low);
          EXPECT_LE(e.value[k], kThree[k].high);
        }
      }
    }
  }
}

TEST(Search, GoesOnWhereAnotherEnded) {
  for (const std::string& name : algorithms()) {
    const SearchOptions options{name, 50, 0.2};
    const std::vector<Evaluation> whole = search_bowl(options, 0.05);
    for (const size_t cut : {size_t(1), size_t(4), size_t(23), whole.size()}) {
      size_t calls = 0;
      const std::vector<Evaluation> past(whole.begin(), whole.begin() + std::ptrdiff_t(cut));
      const std::vector<Evaluation> again = search_bowl(options, 0.05, past, &calls);
      ASSERT_EQ(again.size(), whole.size());
      EXPECT_EQ(calls, whole.size() - cut);
      for (size_t i = 0; i < whole.size(); ++i) {
        EXPECT_EQ(again[i].value, whole[i].value);
        EXPECT_EQ(again[i].outcome.objective, whole[i].outcome.objective);
      }
    }
    std::vector<Evaluation> other(whole.begin(), whole.begin() + 5);
    other[3].value[0] = 0.02;
    EXPECT_THROW(search_bowl(options, 0.05, other), std::invalid_argument);
  }
}

TEST(Search, PassesOnWhatTheObjectiveThrows) {
  size_t calls = 0, kept = 0;
  const auto third = [&](std::span<const double> v) {
    if (++calls == 3) throw std::runtime_error("disk full");
    return bowl(v);
  };
  EXPECT_THROW(search(kThree, kStart, {}, third, {},
                      [&](std::span<const Evaluation> so_far) { kept = so_far.size(); }),
               std::runtime_error);
  EXPECT_EQ(kept, 2u);
  const auto nowhere = [](std::span<const double>) { return Outcome{NAN, {}}; };
  EXPECT_THROW(search(kThree, kStart, {}, nowhere), std::invalid_argument);
}

TEST(Search, RefusesWhatMakesNoSense) {
  const auto any = [](std::span<const double> v) { return bowl(v); };
  EXPECT_THROW(search({}, {}, {}, any), std::invalid_argument);
  EXPECT_THROW(search(kThree, std::vector<double>{1}, {}, any), std::invalid_argument);
  EXPECT_THROW(search(kThree, kStart, {"newton", 10, 0.2}, any), std::invalid_argument);
  EXPECT_THROW(search(kThree, kStart, {"cobyla", 0, 0.2}, any), std::invalid_argument);
  const std::vector<Parameter> one = {{"a", 1, 2, Scale::kLinear}}, none = {{"a", 2, 2}};
  const std::vector<double> at = {1.5};
  EXPECT_THROW(search(one, at, {"bobyqa", 10, 0.2}, any), std::invalid_argument);
  EXPECT_THROW(search(none, at, {}, any), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::optimize
