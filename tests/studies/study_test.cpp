#include "studies/study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "studies/studies.hpp"
#include "studies/targets.hpp"
#include "studies/transfer.hpp"
#include "studies/vegetation.hpp"
#include "underbrush/fit/parameters.hpp"

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

double distance_on_planes(const StudyResult& result, const char* contender) {
  return result.figures.at("static")
      .at("planes")
      .at("models")
      .at(contender)
      .at("distance")
      .get<double>();
}

// The farthest return of the drive is nearer than the ground is from above, which is no limit of
// the sensor.
TEST(Study, AModelAnswersFromAboveItsLog) {
  StudyRun run;
  run.quick = true;
  const Json seen = study_viewpoints(run).figures;
  for (const auto& [view, sources] : seen.items()) {
    const Json &model = sources.at("default"), &always = sources.at("always hit");
    EXPECT_LT(model.at("capped_error_m").get<double>(),
              0.4 * always.at("capped_error_m").get<double>())
        << view;
  }
  EXPECT_GT(seen.at("overhead").at("default").at("answered").get<double>(), 0.95);
}

TEST(Study, VegetationIsJudgedByTheDefault) {
  const StudyResult found = planes();
  EXPECT_EQ(found.tables.at(0).rows.at(4).at(0),
            kDefault);  // below the published ones and the baselines
  EXPECT_EQ(found.checks.at(0).value, distance_on_planes(found, kDefault));
  // The repeated directions show the sensor's noise to the default, too.
  EXPECT_EQ(verdict(found.checks), "holds");
  EXPECT_LT(distance_on_planes(found, kDefault), 0.02);
  EXPECT_LT(distance_on_planes(found, "default with options"), 0.02);
  // Matter that stands still is the same in all repetitions of a beam, whose spread it lacks.
  const StudyResult still = planes([](elements::Model& model) { model.sway_s = 0; });
  EXPECT_GT(distance_on_planes(still, "default with options"), 0.2);
  // The paper's protocol draws it anew, and a model for such logs keeps the limit, too.
  EXPECT_LT(distance_on_planes(still, "default with options, anew"), 0.03);
  EXPECT_LT(distance_on_planes(found, "likelihood"), 0.02);
  EXPECT_LT(distance_on_planes(found, "likelihood"),
            1.5 * distance_on_planes(found, "hierarchical"));  // its start
}

TEST(Study, ContendersOfThePaperHaveTheParametersOfItsConfigurations) {
  const auto holds = [](const std::vector<Contender>& contenders, const std::string& name,
                        const std::string& file) {
    const auto c = std::find_if(contenders.begin(), contenders.end(),
                                [&](const Contender& x) { return x.name == name; });
    ASSERT_NE(c, contenders.end());
    std::ifstream in(std::string(UNDERBRUSH_CONFIGS) + file);
    size_t compared = 0;
    for (std::string line; std::getline(in, line);) {
      const size_t colon = line.find(": ");
      if (line.empty() || line[0] == '#') continue;
      for (const fit::Parameter& p : fit::parameters()) {
        if (p.name != line.substr(0, colon)) continue;
        ++compared;
        EXPECT_EQ(text_of(p, c->fit), line.substr(colon + 2)) << file << " " << p.name;
      }
    }
    EXPECT_GE(compared, 5u);
  };
  holds(static_contenders(1), "voxel", "vegetation-paper-static.yaml");
  holds(static_contenders(1), "voxel, cone", "vegetation-paper-static.yaml");
  holds(mobile_contenders(1), "voxel", "vegetation-paper.yaml");
  holds(mobile_contenders(1), "surface", "vegetation-surface-mobile.yaml");
}

TEST(Study, VegetationFallsShortOnABrokenModelInThePapersProtocol) {
  const StudyResult permeable = planes([](elements::Model& model) {
    for (elements::Ellipsoid& e : model.ellipsoids) {
      e.hit.p *= 0.5f;
      e.density_per_m *= 0.1f;  // which the models of the likelihood have in its place
    }
  });
  EXPECT_GT(distance_on_planes(permeable, "likelihood"), 0.02);
  const StudyResult displaced = planes([](elements::Model& model) {
    for (elements::Ellipsoid& e : model.ellipsoids) e.mean.x() += 0.01f;
  });
  EXPECT_GT(distance_on_planes(displaced, "likelihood"), 0.02);
}

TEST(Study, VegetationChecksHaveThePapersFactors) {
  std::vector<Contender> contenders{{kDefault, {}}, {"mesh", {}}, {"volumes", {}}};
  contenders[1].fit.fitter = "rimls";
  TargetScores target;
  target.target = "tree_low";
  target.scores["mesh"].distance = 0.62;
  target.scores["volumes"].distance = 1e-6;  // It is not judged, however good it is.
  for (const auto& [distance, holds] : {std::pair{0.056, true}, {0.057, false}}) {
    target.scores[kDefault].distance = distance;
    EXPECT_EQ(static_checks(contenders, {target}).at(0).holds(), holds) << distance;
  }
  target.scores[kDefault].distance = INFINITY;
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
  EXPECT_EQ(short_from(broken, "ouster-os1-64"), 1u) << verdict(broken.checks);
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
