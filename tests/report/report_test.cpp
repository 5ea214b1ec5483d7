// The report of `underbrush score --report`: one file that loads nothing, whatever the logs hold,
// and whose script runs in a browser without errors.
#include "report/report.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>

#include "io/temporary.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush {
namespace {

using io::bytes_of;

// Makes `scans` turns of 8 rings inside a round wall of 12 m, with misses upwards.
BeamLog round_wall(int scans, int columns) {
  BeamLog log;
  log.info.has_misses = true;
  log.info.max_range_m = 60;
  log.resize(size_t(scans) * 8 * columns);
  size_t i = 0;
  for (int s = 0; s < scans; ++s) {
    for (int c = 0; c < columns; ++c) {
      for (int ring = 0; ring < 8; ++ring, ++i) {
        const double azimuth = 2 * M_PI * c / columns, elevation = 0.05 * (ring - 5);
        log.origin[i] = {5e6 + s, 0, 2};
        log.direction[i] =
            Vec3f(float(std::cos(elevation) * std::cos(azimuth)),
                  float(std::cos(elevation) * std::sin(azimuth)), float(std::sin(elevation)));
        log.ring[i] = uint16_t(ring);
        log.scan[i] = uint32_t(s);
        log.packet[i] = uint32_t(c);
        if (ring < 7) log.range_m[i] = float(12 / std::cos(elevation));
      }
    }
  }
  return log;
}

// Makes the same beams with errors of every kind.
BeamLog disturbed(const BeamLog& log, uint64_t seed) {
  BeamLog out = log;
  Stream random(seed);
  for (size_t i = 0; i < out.size(); ++i) {
    const double u = random.uniform();
    if (u < 0.1) out.range_m[i] = out.is_hit(i) ? kMiss : 20.f;
    if (out.is_hit(i)) out.range_m[i] += float(0.3 * random.normal());
  }
  return out;
}

BeamLog all_missed(BeamLog log) {
  std::fill(log.range_m.begin(), log.range_m.end(), kMiss);
  return log;
}

class Report : public testing::Test {
 protected:
  const io::TemporaryFolder folder_;

  int run(const std::string& command) {
    const std::string all = "cd " + folder_.path().string() + " && " + command + " 2> stderr";
    return WEXITSTATUS(std::system(all.c_str()));
  }
  // Scores the logs and gives the page; empty where the program fails.
  std::string page(const BeamLog& real, const std::vector<BeamLog>& simulated,
                   const std::string& options = "") {
    io::write_log(folder_ / "real.ply", real, "{}");
    std::string logs;
    for (size_t k = 0; k < simulated.size(); ++k) {
      const std::string name = "model-" + std::to_string(k) + ".ply";
      io::write_log(folder_ / name, simulated[k], "{}");
      logs += " " + name;
    }
    const int code = run(UNDERBRUSH_PROGRAM " score real.ply" + logs + " --report page " + options +
                         " > stdout");
    EXPECT_EQ(code, 0) << bytes_of(folder_ / "stderr");
    return bytes_of(folder_ / "page/index.html");
  }
  // Scores the logs without a page.
  report::Comparison comparison(const std::string& title, const BeamLog& real,
                                const BeamLog& simulated, const std::string& name) {
    io::write_log(folder_ / (name + "-real.ply"), real, "{}");
    io::write_log(folder_ / (name + ".ply"), simulated, "{}");
    const int code = run(UNDERBRUSH_PROGRAM " score " + name + "-real.ply " + name +
                         ".ply --json " + name + ".json > stdout");
    EXPECT_EQ(code, 0) << bytes_of(folder_ / "stderr");
    return {title,
            "note on " + name,
            report::Json::parse(bytes_of(folder_ / (name + ".json"))),
            folder_ / (name + "-real.ply"),
            {{name, folder_ / (name + ".ply")}}};
  }
  // The page as the browser's script leaves it; empty where there is no browser.
  std::string drawn(const std::string& after = "") {
    const char* browser =
        std::system("command -v chromium > /dev/null") == 0 ? "chromium" : nullptr;
    if (!browser) return "";
    std::string html = bytes_of(folder_ / "page/index.html");
    html.insert(html.rfind("</body>"), "<script>" + after + "</script>");
    io::put_bytes(folder_ / "try.html", html);
    const std::string command =
        std::string(browser) +
        " --headless --no-sandbox --disable-gpu-sandbox --use-gl=angle --use-angle=swiftshader "
        "--enable-unsafe-swiftshader --user-data-dir=profile --virtual-time-budget=3000 "
        "--dump-dom file://" +
        (folder_ / "try.html").string() + " > drawn.html";
    EXPECT_EQ(run("timeout 60 " + command), 0);
    return bytes_of(folder_ / "drawn.html");
  }
};

void expect_self_contained(const std::string& page) {
  ASSERT_FALSE(page.empty());
  const std::regex loads(
      "https?://|(src|href|srcset|data)\\s*=\\s*[\"']?(?!data:)[a-z./]|@import|url\\(",
      std::regex::icase);
  // The script and the pictures are left out, because they are too long for a regular expression.
  std::string text = page.substr(0, page.find("<script"));
  for (size_t at = 0; (at = text.find("base64,", at)) != std::string::npos; ++at) {
    text.erase(at + 7, text.find('"', at) - at - 7);
  }
  std::smatch found;
  EXPECT_FALSE(std::regex_search(text, found, loads)) << found.str();
  const std::string script = page.substr(page.rfind("<script>"));
  for (const char* word : {"http:", "https:", "fetch(", "XMLHttpRequest", "import("}) {
    EXPECT_EQ(script.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(page.find("@@"), std::string::npos);
}

TEST_F(Report, IsOneFileWithEveryModel) {
  const BeamLog real = round_wall(3, 90);
  const std::string html = page(real, {disturbed(real, 1), disturbed(real, 2)},
                                "--name 'fine & <b>bold</b>' --name '</script>second'");
  expect_self_contained(html);
  EXPECT_NE(html.find("fine &amp; &lt;b&gt;bold&lt;/b&gt;"), std::string::npos);
  EXPECT_NE(html.find("&lt;/script&gt;second"), std::string::npos);
  EXPECT_EQ(html.find("</script>second"), std::string::npos);
  EXPECT_NE(html.find("8 rings"), std::string::npos);
  EXPECT_NE(bytes_of(folder_ / "stdout").find("report: page/index.html"), std::string::npos);
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "page")) {
    files += entry.is_regular_file();
  }
  EXPECT_EQ(files, 1u);
}

TEST_F(Report, HasTheBaselinesBesideTheModels) {
  const BeamLog real = round_wall(2, 60);
  const std::string column = "always hit<small>baseline</small>";
  const std::string alone = page(real, {disturbed(real, 3)}, "--json score.json");
  EXPECT_NE(alone.find(column), std::string::npos);
  EXPECT_EQ(alone.find("look-up"), std::string::npos);
  EXPECT_NE(alone.find("median range of its ring in the real log"), std::string::npos);
  EXPECT_NE(bytes_of(folder_ / "stdout").find("of its ring in real.ply"), std::string::npos);
  const auto baselines = [&] {
    return report::Json::parse(bytes_of(folder_ / "score.json")).at("baselines");
  };
  // The wall is round, so the medians of the rings are its ranges; misses are all that is wrong.
  EXPECT_EQ(baselines().at("always hit").at("informedness"), 0);
  EXPECT_NEAR(double(baselines().at("always hit").at("packet_error_m")), 0, 1e-5);
  EXPECT_NEAR(double(baselines().at("always hit").at("capped_error_m")), 2.0 / 8, 1e-5);
  BeamLog train = real;
  for (float& range : train.range_m) range += 1;  // Of misses they stay infinite.
  io::write_log(folder_ / "train.ply", train, "{}");
  const std::string html = page(real, {disturbed(real, 3)}, "--train train.ply --json score.json");
  EXPECT_NE(html.find(column), std::string::npos);
  EXPECT_NE(html.find("look-up<small>baseline</small>"), std::string::npos);
  EXPECT_NE(html.find("median range of its ring in the training log"), std::string::npos);
  EXPECT_NE(bytes_of(folder_ / "stdout").find("of its ring in train.ply"), std::string::npos);
  EXPECT_NEAR(double(baselines().at("always hit").at("packet_error_m")), 1, 1e-5);
  EXPECT_GT(double(baselines().at("look-up").at("packet_error_m")), 0.9);
  EXPECT_EQ(baselines().at("look-up").at("informedness"), 1);
}

TEST_F(Report, SameLogsSamePage) {
  const BeamLog real = round_wall(2, 60);
  const std::string once = page(real, {disturbed(real, 3)});
  EXPECT_EQ(once, page(real, {disturbed(real, 3)}));
}

TEST_F(Report, LogsWithoutHitsOrOfOneBeam) {
  const BeamLog real = round_wall(1, 30);
  expect_self_contained(page(all_missed(real), {all_missed(real)}));
  EXPECT_NE(bytes_of(folder_ / "page/index.html").find("n/a"), std::string::npos);
  expect_self_contained(page(all_missed(real), {real}));
  expect_self_contained(page(real, {all_missed(real)}));
  BeamLog one = real.like();
  one.append(real, 0);
  expect_self_contained(page(one, {one}));
}

TEST_F(Report, AConstantIsABaselineAndNoBestValue) {
  BeamLog real = round_wall(1, 60);
  for (size_t i = 0; i < real.size(); ++i) real.intensity[i] = float(i % 7);
  const std::string html = page(real, {disturbed(real, 1), disturbed(real, 2)});
  const auto row = [&](const std::string& name) {
    const size_t at = html.find("<tr><th>" + name + "\u00a0<");  // no break before the arrow
    EXPECT_NE(at, std::string::npos) << name;
    return html.substr(std::min(at, html.size()), html.find("</tr>", at) - at);
  };
  EXPECT_NE(row("Intensity RMSE").find("class=\"best\""), std::string::npos);
  EXPECT_EQ(row("Intensity RMSE of a constant").find("class=\"best\""), std::string::npos);
}

TEST_F(Report, AFailureLeavesTheOldPage) {
  const BeamLog real = round_wall(1, 30);
  page(real, {real});
  io::put_bytes(folder_ / "page/index.html", "old");
  io::write_log(folder_ / "real.ply", round_wall(1, 31), "{}");
  EXPECT_EQ(run(UNDERBRUSH_PROGRAM " score real.ply model-0.ply --report page --force > stdout"),
            3);
  EXPECT_EQ(bytes_of(folder_ / "page/index.html"), "old");
}

TEST_F(Report, DrawsInABrowser) {
  const BeamLog real = round_wall(3, 90);
  for (const BeamLog& log : {real, all_missed(real)}) {
    page(log, {disturbed(log, 4), all_missed(log)});
    const std::string html = drawn(
        "for (const b of document.querySelectorAll('button')) b.click();"
        "for (const b of document.querySelectorAll('button')) b.click();"
        "const c = document.querySelector('canvas');"
        "c.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'}));"
        "c.dispatchEvent(new WheelEvent('wheel', {deltaY: 50}));");
    if (html.empty()) GTEST_SKIP() << "no chromium: the report's script was not run";
    EXPECT_NE(html.find("data-drawn=\"yes\""), std::string::npos);
    std::smatch error;
    std::regex_search(html, error, std::regex("id=\"script-error\"[^>]*>([^<]*)"));
    EXPECT_EQ(error[1].str(), "");
  }
}

// All matches of the first group.
std::vector<std::string> all_of(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at) {
    found.push_back((*at)[1].str());
  }
  return found;
}

TEST_F(Report, SeveralComparisonsOnOnePage) {
  const BeamLog near = round_wall(3, 90), far = round_wall(2, 60);
  report::ReportInput input{"Two <logs>", "What they are.", {}};
  input.comparisons.push_back(comparison("First: \"near\"", near, disturbed(near, 1), "one"));
  input.comparisons.push_back(comparison("Second & last", far, disturbed(far, 2), "two"));
  report::write_report(folder_ / "page", input);
  const std::string html = bytes_of(folder_ / "page/index.html");
  expect_self_contained(html);
  EXPECT_EQ(all_of(html, "<h1>([^<]*)</h1>"), std::vector<std::string>{"Two &lt;logs&gt;"});
  EXPECT_EQ(all_of(html, "<h2>([^<]*)</h2>"),
            (std::vector<std::string>{"First: &quot;near&quot;", "Second &amp; last"}));
  for (const char* text :
       {"What they are.", "note on one", "note on two", "one-real.ply: ", "two-real.ply: "}) {
    EXPECT_NE(html.find(text), std::string::npos) << text;
  }
  const std::string body = html.substr(0, html.find("<script"));
  const std::vector<std::string> ids = all_of(body, " id=\"([^\"]*)\""),
                                 links = all_of(body, "href=\"#([^\"]*)\"");
  const std::set<std::string> different(ids.begin(), ids.end());
  EXPECT_EQ(different.size(), ids.size());
  EXPECT_GE(links.size(), 14u);
  for (const std::string& link : links) EXPECT_TRUE(different.count(link)) << link;

  const std::string shown = drawn(
      "for (const b of document.querySelectorAll('button')) b.click();"
      "document.documentElement.dataset.parts = [...document.querySelectorAll('.comparison')]"
      ".map((c) => [c.querySelectorAll('.plot svg').length, c.querySelector('.view').hidden,"
      "c.querySelectorAll('.buttons button').length].join()).join(';');");
  if (shown.empty()) GTEST_SKIP() << "no chromium: the report's script was not run";
  EXPECT_NE(shown.find("data-drawn=\"yes\""), std::string::npos);
  EXPECT_EQ(all_of(shown, "data-parts=\"([^\"]*)\""),
            std::vector<std::string>{"2,false,9;2,false,9"});
  EXPECT_EQ(all_of(shown, "id=\"script-error\"[^>]*>([^<]*)"), std::vector<std::string>{""});
}

TEST_F(Report, AnErrorOfTheScriptIsSeen) {
  const BeamLog real = round_wall(1, 30);
  page(real, {real});
  const std::string html = drawn("no_such_function();");
  if (html.empty()) GTEST_SKIP() << "no chromium: the report's script was not run";
  EXPECT_NE(html.find("Script error: Uncaught ReferenceError"), std::string::npos);
}

}  // namespace
}  // namespace underbrush
