// This study asks whether matter that is learnt from a log is true: how dense a model makes a slab
// of leaves, and how many beams of other places the model lets through.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/studies.hpp"
#include "studies/transmission.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/rasters/canopy.hpp"

namespace underbrush::studies {
namespace {

/// A slab, its name in the tables, and how it is measured and learnt.
struct SlabCase {
  std::string name;
  TurbidSlab slab;
  bool judged = true;     ///< Whether the verdict is about it.
  double step_deg = 0.6;  ///< Between the beams of the tripods.
  bool meshes = false;    ///< Whether voxels and meshes are fitted besides.
};

std::vector<SlabCase> slab_cases(bool quick) {
  using enum LeafAngles;
  if (quick) return {{"spherical 0.5, 1.2°", {0.5}, true, 1.2}};
  return {{"spherical 0.2", {0.2}},
          {"spherical 0.5", {0.5}},
          {"spherical 1.0", {1.0}},
          {"horizontal 0.5", {0.5, kHorizontal}},
          {"vertical 0.5", {0.5, kVertical}},
          {"spherical 0.5, 1.2°", {0.5}, true, 1.2, true},
          {"spherical 0.2, 5 mrad", {0.2, kSpherical, 0.005}, false},
          {"spherical 0.2, 20 mrad", {0.2, kSpherical, 0.02}, false}};
}

/// A way to learn a slab, whose name is the one in the tables.
struct SlabFit {
  std::string name;
  fit::FitOptions options;
  /// The most beams of a view that are answered. A mesh through leaves has millions of triangles in
  /// each other's way, which makes it slow.
  size_t most_beams = 100'000;
};

/// Returns the ways to fit, of which the first is the default.
std::vector<SlabFit> slab_fits(const StudyRun& run, bool meshes) {
  std::vector<SlabFit> out{{"default", {}}, {"hierarchical", {}}, {"hierarchical, counts", {}}};
  out[1].options.fitter = out[2].options.fitter = "hierarchical";
  out[2].options.credit.ellipsoid.a = 0;
  out[2].options.free_space_below = 0;
  if (meshes) {
    out.push_back({"voxel", {}});
    out.back().options.fitter = "voxel";
    for (const bool carve : {false, true}) {
      out.push_back({carve ? "mesh, carved" : "mesh", {}});
      out.back().options.fitter = "surface";
      out.back().options.surface.carve = carve;
      out.back().most_beams = 5'000;
    }
  }
  for (SlabFit& f : out) f.options.seed = run.seed;
  return out;
}

/// The beams of a slab: the log to learn from, its cells, and the beams whose answers are asked.
struct SlabLogs {
  BeamLog train;
  SlabCells cells;
  std::vector<BeamLog> views;
};

SlabLogs slab_logs(const StudyRun& run, const SlabCase& asked) {
  const TurbidSlab& slab = asked.slab;
  BeamLog train = measured(slab, tripod_beams(asked.step_deg * M_PI / 180), run.seed);
  SlabCells cells(train, slab.angles);
  std::vector<BeamLog> views;
  for (size_t view = 0; view < std::size(kSlabViews); ++view) {
    // Few beams of the overhead view pass the densest slab.
    const bool many = !run.quick && SlabView(view) == SlabView::kOverhead;
    views.push_back(view_beams(SlabView(view), many ? 100'000 : 30'000, run.seed + 1));
  }
  return {std::move(train), std::move(cells), std::move(views)};
}

SlabAnswer true_answer(const TurbidSlab& slab, const SlabLogs& logs) {
  SlabAnswer out = densities_of([&](int, int, int) { return slab.area_density; }, logs.cells);
  for (size_t k = 0; k < logs.views.size(); ++k) {
    const Transmission truth = true_transmission(slab, logs.views[k]);
    out.transmission[k] = truth.share;
    out.error[k] = truth.error;
  }
  return out;
}

SlabAnswer plain_answer(const SlabLogs& logs) {
  SlabAnswer out = densities_of(
      [&](int x, int y, int z) { return logs.cells.at(x, y, z).density(); }, logs.cells);
  out.covered = NAN;
  for (size_t k = 0; k < logs.views.size(); ++k) {
    out.transmission[k] = logs.cells.transmission(logs.views[k]);
  }
  return out;
}

/// Returns what the verbs `rasters` and `simulate` answer of a model. The area densities that
/// `rasters` gives of a model of spherical leaves are converted to the angles of the slab.
SlabAnswer model_answer(const elements::Model& model, const TurbidSlab& slab, const SlabLogs& logs,
                        size_t most_beams, uint64_t seed) {
  pipeline::World world;
  world.scene.models.push_back(model);
  const pipeline::TracedWorld traced(world.scene, world.info);
  const rasters::Canopy canopy = rasters::canopy_of(world.scene, traced.still());
  const bool spherical = model.leaf_angles.spherical();
  const double convert = spherical ? slab.area_density / area_density_of_voxels(slab) : 1;
  const Eigen::Vector3i shift =
      (Vec3(-TurbidSlab::kHalfWidthM, -TurbidSlab::kHalfWidthM, TurbidSlab::kLowM) - canopy.low)
          .array()
          .round()
          .cast<int>();
  const auto density = [&](int x, int y, int z) {
    const Eigen::Vector3i at = Eigen::Vector3i(x, y, z) + shift;
    for (int d = 0; d < 3; ++d) {
      if (at[d] < 0 || at[d] >= int(canopy.size[size_t(d)])) return 0.0;
    }
    const size_t row = size_t(at.z()) * canopy.size[1] + size_t(at.y());
    return convert * double(canopy.area_density[row * canopy.size[0] + size_t(at.x())]);
  };
  SlabAnswer out = densities_of(density, logs.cells);
  pipeline::SimulateOptions options;
  options.seed = seed;
  pipeline::Simulation simulation(traced, options);
  for (size_t k = 0; k < logs.views.size(); ++k) {
    BeamLog beams = logs.views[k].like();
    beams.append(logs.views[k], 0, std::min(most_beams, logs.views[k].size()));
    out.transmission[k] = transmission_of(pipeline::simulate_log(simulation, std::move(beams)));
  }
  return out;
}

Json json_of_answer(const SlabAnswer& a) {
  Json out{{"area_density", io::finite_or_null(a.area_density)},
           {"covered", io::finite_or_null(a.covered)},
           {"opaque", a.opaque}};
  for (const double v : a.layer) out["layers"].push_back(io::finite_or_null(v));
  for (size_t k = 0; k < std::size(kSlabViews); ++k) {
    out["transmission"][kSlabViews[k]] = a.transmission[k];
    if (a.error[k] > 0) out["error"][kSlabViews[k]] = a.error[k];
  }
  return out;
}

std::vector<std::string> row_of(const std::string& name, const SlabAnswer& a) {
  const auto [least, greatest] = std::minmax_element(a.layer.begin() + 1, a.layer.end() - 1);
  std::vector<std::string> out{
      name, fmt::format("{:.3f}", a.area_density),
      fmt::format("{:.3f} to {:.3f}", *least, *greatest),
      fmt::format("{:.3f} / {:.3f}", a.layer.front(), a.layer.back()),
      std::isnan(a.covered) ? "–" : fmt::format("{:.1f}", 100 * a.covered)};
  for (size_t k = 0; k < std::size(kSlabViews); ++k) {
    out.push_back(fmt::format("{:.2f}", 100 * a.transmission[k]));
    if (a.error[k] > 0) out.back() += fmt::format(" ± {:.2f}", 100 * a.error[k]);
  }
  return out;
}

/// Compares all sources on one slab.
void add_slab(const StudyRun& run, const SlabCase& asked, report::Table& table,
              StudyResult& result) {
  const SlabLogs logs = slab_logs(run, asked);
  const SlabAnswer truth = true_answer(asked.slab, logs);
  Json& figures = result.figures[asked.name];
  const auto add = [&](const std::string& source, const SlabAnswer& answer) {
    table.rows.push_back(row_of(asked.name + "/" + source, answer));
    figures[source] = json_of_answer(answer);
  };
  add("truth", truth);
  add("plain", plain_answer(logs));
  if (!run.keep.empty()) {
    std::filesystem::create_directories(run.keep);
    MemorySource source(logs.train);
    io::export_log(run.keep / (asked.name + ".ply"), source, "", "{}");
  }
  for (const SlabFit& f : slab_fits(run, asked.meshes)) {
    run.say(fmt::format("{}: {}", asked.name, f.name));
    MemorySource source(logs.train);
    const elements::Model model = pipeline::fit_model({source}, f.options).model;
    const SlabAnswer answer = model_answer(model, asked.slab, logs, f.most_beams, run.seed);
    add(f.name, answer);
    if (!run.keep.empty()) write_model(run.keep / (asked.name + ", " + f.name), model);
    if (asked.judged && f.name == "default") {
      for (const Check& c : slab_checks(asked.name, answer, truth)) result.checks.push_back(c);
    }
  }
}

}  // namespace

StudyResult study_transmission(const StudyRun& run) {
  StudyResult out;
  out.lead =
      "Slabs of leaves whose area density is known, learnt from five tripods below: how dense each "
      "model makes them, and how many beams it lets through.";
  report::Table table{
      "Turbid slabs",
      "Slabs of 10 m by their leaf angles and area density. Area density: mean over the inner 18 m "
      "× 18 m. Layers: least and greatest of the eight inner layers of 1 m, and the lowest and the "
      "highest one. Cells held: share of the cells of 1 m³ reached by at least 50 beams whose 95 % "
      "interval from the log's own hits and path lengths holds the density. Transmission: share of "
      "the beams that pass the slab.",
      {"slab/source", "area density, m²/m³", "layers", "lowest / highest", "cells held, %",
       "tripods, %", "overhead, %", "mobile, %"},
      {}};
  for (const SlabCase& c : slab_cases(run.quick)) add_slab(run, c, table, out);
  out.tables.push_back(std::move(table));
  return out;
}

}  // namespace underbrush::studies
