#include "underbrush/optimize/checkpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::optimize {
namespace {

TEST(Checkpoint, ComesBackToTheLastBit) {
  const io::TemporaryFolder folder;
  Checkpoint c{R"({"seed":1,"fixed":{}})", true, {}};
  c.evaluations.push_back({{0.1, 1.0 / 3, 5e-324}, {M_PI, {{"f1", 0.1 + 0.2}}}});
  c.evaluations.push_back({{1e300, -0.0, 7}, {-1, {{"f1", NAN}}}});
  write_checkpoint(folder / "c", c);
  const Checkpoint r = read_checkpoint(folder / "c");
  EXPECT_EQ(r.run, c.run);
  EXPECT_TRUE(r.finished);
  ASSERT_EQ(r.evaluations.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(r.evaluations[i].value, c.evaluations[i].value);
    EXPECT_EQ(r.evaluations[i].outcome.objective, c.evaluations[i].outcome.objective);
  }
  EXPECT_EQ(r.evaluations[0].outcome.score, c.evaluations[0].outcome.score);
  EXPECT_TRUE(std::isnan(r.evaluations[1].outcome.score.at("f1")));
}

TEST(Checkpoint, ThatIsDamagedIsRefused) {
  const io::TemporaryFolder folder;
  write_checkpoint(folder / "c", {"{}", false, {{{1}, {2, {}}}}});
  std::ifstream in(folder / "c");
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  EXPECT_THROW(read_checkpoint(folder / "none"), FormatError);
  for (size_t n = 0; n + 2 < whole.size(); n += 7) {
    std::ofstream(folder / "cut") << whole.substr(0, n);
    EXPECT_THROW(read_checkpoint(folder / "cut"), FormatError) << n;
  }
  for (const char* text : {"[]", "{}", R"({"format":"underbrush-optimize","version":2})", "null",
                           R"({"format":"underbrush-optimize","version":1,"finished":true,"run":{},
                               "evaluations":[{"value":["x"],"objective":1}]})"}) {
    std::ofstream(folder / "bad") << text;
    EXPECT_THROW(read_checkpoint(folder / "bad"), FormatError) << text;
  }
}

}  // namespace
}  // namespace underbrush::optimize
