#include "studies/study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "studies/targets.hpp"
#include "studies/transfer.hpp"
#include "studies/vegetation.hpp"

namespace underbrush::studies {
namespace {

StudyResult planes(const std::function<void(elements::Model&)>& change = {}) {
  StudyRun run;
  run.quick = true;
  StudyResult result;
  add_static_targets(run, {"planes"}, result, change);
  return result;
}

TEST(Study, VerdictIsThatOfItsChecks) {
  EXPECT_EQ(verdict({}), "falls short: nothing was compared");
  std::vector<Check> checks{{"a", 0.01, 0.02}, {"b", 7, 7, false}};
  EXPECT_EQ(verdict(checks), "holds");
  checks.push_back({"c", 0.031, 0.02});
  checks.push_back({"d", 2, 9, false});
  checks.push_back({"e", NAN, 1});
  EXPECT_EQ(verdict(checks),
            "falls short: c: 0.031, must be at most 0.02; d: 2, must be at least 9; "
            "e: nan, must be at most 1");
}

TEST(Study, VegetationVerdictFailsOnABrokenModel) {
  const StudyResult good = planes();
  EXPECT_EQ(verdict(good.checks), "holds");
  const auto distance = [&](const char* contender) {
    return good.figures.at("static")
        .at("planes")
        .at("models")
        .at(contender)
        .at("distance")
        .get<double>();
  };
  EXPECT_LT(distance("likelihood"), 1.5 * distance("hierarchical"));  // its start
  const StudyResult permeable = planes([](elements::Model& model) {
    for (elements::Ellipsoid& e : model.ellipsoids) {
      e.hit.p *= 0.5f;
      e.density_per_m *= 0.1f;  // which the models of the likelihood have in its place
    }
  });
  EXPECT_EQ(verdict(permeable.checks).rfind("falls short: ", 0), 0u);
  const StudyResult displaced = planes([](elements::Model& model) {
    for (elements::Ellipsoid& e : model.ellipsoids) e.mean.x() += 0.01f;
  });
  EXPECT_EQ(verdict(displaced.checks).rfind("falls short: ", 0), 0u);
}

TEST(Study, VegetationChecksHaveThePapersFactors) {
  std::vector<Contender> contenders{{"mesh", {}, false}, {"volumes", {}, false}};
  contenders[0].fit.fitter = "rimls";
  TargetScores target;
  target.target = "tree_low";
  target.scores["mesh"].distance = 0.62;
  for (const auto& [distance, holds] : {std::pair{0.056, true}, {0.057, false}}) {
    target.scores["volumes"].distance = distance;
    EXPECT_EQ(static_checks(contenders, {target}).at(0).holds(), holds) << distance;
  }
  target.scores["volumes"].distance = INFINITY;
  EXPECT_FALSE(static_checks(contenders, {target}).at(0).holds());
}

TEST(Study, TransferMayLoseATenth) {
  metrics::Summary native, transferred;
  native.f1 = 0.9;
  native.cloud_error_m = 0.04;
  for (const auto& [f1, cloud, holds] : {std::tuple{0.82, 0.043, true},
                                         {0.95, 0.01, true},
                                         {0.8, 0.043, false},
                                         {0.82, 0.045, false},
                                         {0.9, metrics::kUnknown, false}}) {
    transferred.f1 = f1;
    transferred.cloud_error_m = cloud;
    EXPECT_EQ(verdict(transfer_checks("a", "b", transferred, native)) == "holds", holds) << f1;
  }
}

// Counts the checks of transfer from a lidar that fail.
size_t short_from(const StudyResult& result, const std::string& lidar) {
  return size_t(std::count_if(result.checks.begin(), result.checks.end(), [&](const Check& c) {
    return c.what.starts_with(lidar + " to ") && !c.holds();
  }));
}

TEST(Study, TransferFallsShortWhereAModelIsBroken) {
  StudyRun run;
  run.quick = true;
  const StudyResult sound = transfer(run, {});
  const StudyResult broken = transfer(run, [](const std::string& lidar, elements::Model& model) {
    if (lidar != "ouster-os1-64") return;
    for (elements::Ellipsoid& e : model.ellipsoids) e.set_covariance(9 * e.covariance_matrix());
  });
  EXPECT_EQ(short_from(sound, "ouster-os1-64"), 0u) << verdict(sound.checks);
  EXPECT_GE(short_from(broken, "ouster-os1-64"), 2u) << verdict(broken.checks);
  EXPECT_NE(verdict(broken.checks).find("ouster-os1-64 to"), std::string::npos);
}

TEST(Study, TrainsOnAFifthAndTestsOnTheRest) {
  StaticScanOptions options;
  options.bearings = 4;
  options.most_lasers = 2;
  options.measurements = 50;
  const StaticScan scan = scan_target("tree_medium", options);
  EXPECT_EQ(scan.directions, 8u);
  EXPECT_EQ(scan.test.size(), 8u * 40);
  EXPECT_EQ(without_margin(scan).size(), 8u * 10);
  EXPECT_EQ(scan.train.size(), size_t(2 + 4) * (4 + 8) * 10);
  for (size_t i = 0; i < scan.test.size(); ++i) EXPECT_NE(scan.test.scan[i] % 5, 0u);
}

TEST(Study, ReportIsOnePageThatLoadsNothing) {
  StudyResult result = planes();
  result.notes.emplace_back("a <note>");
  const io::TemporaryFolder folder;
  const auto page = write_study_report(folder.path(), studies()[0], result, "{\"seed\": 1}");
  std::ifstream in(page);
  const std::string html{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(html.find("Verdict: holds"), std::string::npos);
  EXPECT_NE(html.find("a &lt;note&gt;"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_EQ(html.find("@@"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("src=\"http"), std::string::npos);
}

}  // namespace
}  // namespace underbrush::studies
