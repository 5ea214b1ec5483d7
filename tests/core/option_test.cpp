#include "underbrush/core/option.hpp"

#include <gtest/gtest.h>

namespace underbrush {
namespace {

struct Options {
  int every = 0;
  unsigned points = 3;
  double angle = NAN, height = 0.5;
  std::string mode = "once", file;
  bool strict = false;
  std::vector<std::string> words{"a", "b"};
  std::vector<double> times{0.5, 2};
};

using O = Options;
const Option<O> kTable[] = {{"every", "", "", "", [](O& o) -> auto& {return o.every;
}  // namespace
, 2, 9
}  // namespace underbrush
, {"points", "", "", "", [](O& o) -> auto& {return o.points;
}
, 1, kNoLimit
}
, {"angle", "", "", "", [](O& o) -> auto& {return o.angle;
}
}
, {"height", "", "m", "", [](O& o) -> auto& {return o.height;
}
, kPositive, kNoLimit
}
, {"mode", "", "", "", [](O& o) -> auto& {return o.mode;
}
, 0, 0, { "once", "anew" }
}
, {"file", "", "", "", [](O& o) -> auto& {return o.file;
}
, 0, 0, {}, "FILE.yaml"
}
, {"strict", "", "", "", [](O& o) -> auto& {return o.strict;
}
}
, {"words", "", "", "", [](O& o) -> auto& {return o.words;
}
}
, {"times", "", "", "", [](O& o) -> auto& {return o.times;
}
, 0, 0, {}, "FROM TO", 2
}
,
}
;

/// Returns what is wrong with the options.
std::string wrong(const Options& options) {
  try {
    check_options("verb", std::span<const Option<O>>(kTable), options);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Option, ValuesAreText) {
  const char* texts[] = {"0", "3", "nan", "0.5", "once", "", "false", "a,b", "0.5,2"};
  const char* types[] = {"int",   "int",           "float",
                         "float", "str",           "str | os.PathLike[str]",
                         "bool",  "Sequence[str]", "Sequence[float]"};
  for (size_t k = 0; k < std::size(kTable); ++k) {
    EXPECT_EQ(text_of(kTable[k], Options()), texts[k]);
    EXPECT_EQ(type_of(kTable[k]), types[k]);
  }
}

TEST(Option, DefaultsOutsideTheLimitsAreNotGiven) {
  EXPECT_EQ(wrong({}), "");
  EXPECT_TRUE(is_outside(kTable[0], Options()));
  EXPECT_FALSE(is_outside(kTable[1], Options()));
  EXPECT_TRUE(is_outside(kTable[2], Options()));
}

TEST(Option, ChecksLimitsAndChoices) {
  const auto with = [](auto set) {
    Options o;
    set(o);
    return wrong(o);
  };
  EXPECT_EQ(with([](O& o) { o.every = 1; }), "verb: every is between 2 and 9, not 1");
  EXPECT_EQ(with([](O& o) { o.every = 9; }), "");
  EXPECT_EQ(with([](O& o) { o.points = 0; }), "verb: points is at least 1, not 0");
  EXPECT_EQ(with([](O& o) { o.height = 0; }), "verb: height is positive, not 0");
  EXPECT_EQ(with([](O& o) { o.height = NAN; }), "verb: height is positive, not nan");
  EXPECT_EQ(with([](O& o) { o.mode = "twice"; }), "verb: mode is one of once, anew, not twice");
  EXPECT_EQ(with([](O& o) { o.angle = 7; }), "");
}

TEST(Option, NumbersAreSetByNumber) {
  Options o;
  set_number(kTable[1], o, 5.9);
  EXPECT_EQ(o.points, 5u);
  EXPECT_EQ(number_of(kTable[1], o), 5);
  set_number(kTable[6], o, 1);
  EXPECT_EQ(number_of(kTable[6], o), 1);
  EXPECT_THROW(number_of(kTable[4], o), std::invalid_argument);
  EXPECT_THROW(set_number(kTable[4], o, 1), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush
