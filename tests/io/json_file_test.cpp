#include "underbrush/io/json_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace {
namespace fs = std::filesystem;

class Json : public testing::Test {
 protected:
  // Returns what the reading of `text` by `read` is refused with.
  template <class Read>
  std::string refused(const std::string& text, const Read& read) {
    std::ofstream(folder_ / "a.json") << text;
    try {
      const JsonFile file(folder_ / "a.json");
      read(file.root());
    } catch (const FormatError& e) {
      const std::string what = e.what();
      const std::string name = (folder_ / "a.json").string() + ": ";
      EXPECT_EQ(what.find(name), 0u) << what;
      return what.substr(std::min(name.size(), what.size()));
    }
    return "nothing";
  }
  TemporaryFolder folder_;
};

TEST_F(Json, ThatIsWrongIsToldWithItsPlace) {
  const auto number = [](const JsonValue& j) { j.at("a").values().at(1).at("b").number(); };
  EXPECT_EQ(refused(R"({"a": [1, {"b": "x"}]})", number),
            "a[1].b: expected a finite number, found '\"x\"'");
  EXPECT_EQ(refused(R"({"a": [1, {}]})", number), "a[1]: has no member 'b'");
  EXPECT_EQ(refused(R"({"a": 7})", number), "a: expected a list [ … ], found '7'");
  EXPECT_EQ(refused("{\n\"a\": nul", number), "line 2: not JSON (a NaN is none either)");
  EXPECT_EQ(refused(R"({"a": 1e999})", number), "not JSON: a number is too large");
  const auto count = [](const JsonValue& j) { j.at("n").count(10); };
  for (const char* n : {"-1", "11", "1.5", "\"1\"", "null"}) {
    EXPECT_NE(refused(std::string(R"({"n": )") + n + "}", count).find("whole number"),
              std::string::npos)
        << n;
  }
}

TEST_F(Json, ThatClosesMoreThanItOpensIsRefused) {
  const auto nothing = [](const JsonValue&) {};
  for (const char* open : {"[", "{", ":", "[{:"}) {
    EXPECT_EQ(refused(std::string(20'000'000, ']') + open, nothing),
              "line 1: not JSON (a NaN is none either)");
  }
}

TEST_F(Json, NestedDeeperThan64LevelsIsRefused) {
  const auto nothing = [](const JsonValue&) {};
  const auto nested = [](size_t levels) {
    return std::string(levels, '[') + std::string(levels, ']');
  };
  EXPECT_EQ(refused(nested(64), nothing), "nothing");
  EXPECT_EQ(refused(nested(65), nothing), "nested too deep");
  EXPECT_EQ(refused(nested(100000), nothing), "nested too deep");
  EXPECT_EQ(refused(std::string(65, '['), nothing), "nested too deep");
  std::string wide = "[[]";
  for (int k = 0; k < 100; ++k) wide += ",[{}]";
  EXPECT_EQ(refused(wide + "]", nothing), "nothing");
  // Brackets in strings are none, and neither does an escaped quotation mark end one.
  EXPECT_EQ(refused(R"(["\\", "\"", ")" + std::string(100, '[') + R"("])", nothing), "nothing");
}

TEST_F(Json, PathsStayInTheFolder) {
  fs::create_directories(folder_ / "models" / "tree");
  fs::create_symlink("/etc", folder_ / "link");
  fs::create_symlink("models", folder_ / "inner");
  const auto inside = [](const JsonValue& j) { j.at("p").path(); };
  const auto outside = [](const JsonValue& j) { j.at("p").path(true); };
  for (const char* p : {"models/tree", "models/../models", "new", "inner/tree", "./a..b"}) {
    EXPECT_EQ(refused(std::string(R"({"p": ")") + p + "\"}", inside), "nothing") << p;
  }
  for (const char* p : {"../x", "models/../../x", "/etc/passwd", "link/passwd", ".."}) {
    const std::string text = std::string(R"({"p": ")") + p + "\"}";
    EXPECT_NE(refused(text, inside).find("leads out"), std::string::npos) << p;
    EXPECT_EQ(refused(text, outside), "nothing") << p;
  }
}

}  // namespace
}  // namespace underbrush::io
