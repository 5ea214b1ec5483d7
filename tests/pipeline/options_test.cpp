#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/actors/learn_actors.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/osi/osi_options.hpp"
#include "underbrush/perception/perceive_options.hpp"
#include "underbrush/pipeline/annotate_site.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/extract_primitives.hpp"
#include "underbrush/pipeline/import_options.hpp"
#include "underbrush/pipeline/mark_movers.hpp"
#include "underbrush/pipeline/mesh_set.hpp"
#include "underbrush/pipeline/segment_log.hpp"
#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/pipeline/split_log.hpp"
#include "underbrush/rasters/rasters.hpp"
#include "underbrush/worlds/read_world.hpp"

namespace underbrush::pipeline {
namespace {

/// Expects that a verb refuses values in the wrong unit: each option with a unit has two limits.
template <class T>
void expect_limits(const char* verb, std::span<const Option<T>> options) {
  for (const Option<T>& o : options) {
    if (o.unit.empty()) continue;
    EXPECT_TRUE(std::isfinite(o.least) && std::isfinite(o.most)) << verb << " --" << o.name;
    EXPECT_NE(o.least, kPositive) << verb << " --" << o.name;
  }
}

TEST(Options, ThoseWithAUnitHaveLimits) {
  expect_limits("actors", actors::actor_options());
  expect_limits("annotate", annotate_options());
  expect_limits("compose", compose_options());
  expect_limits("extract", extract_options());
  expect_limits("import", import_options());
  expect_limits("meshes", meshes_options());
  expect_limits("movers", movers::mover_options());
  expect_limits("osi", osi::osi_options());
  expect_limits("perceive", perception::perceive_options());
  expect_limits("rasters", rasters::raster_options());
  expect_limits("segment", segment_options());
  expect_limits("simulate", simulate_options());
  expect_limits("simulate", worlds::read_options());
  expect_limits("split", split_options());
  for (const fit::Parameter& p : fit::parameters()) {
    if (p.unit.empty()) continue;
    EXPECT_TRUE(std::isfinite(p.least) && std::isfinite(p.most)) << "fit --" << p.name;
  }
}

TEST(Options, CellsOfTheMapOfUnknownSpaceAreNotTiny) {
  BeamLog log;
  log.resize(1);
  MemorySource source(log);
  fit::FitOptions options;
  options.unknown_cell_m = 0.001;
  try {
    fit::fit(source, options, {});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("unknown-cell"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace underbrush::pipeline
