#include "underbrush/pipeline/annotate_site.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/log_ground.hpp"

namespace underbrush::pipeline {
namespace {

constexpr const char* kLike = "like";
constexpr double kLeastPartM = 10;  // smaller ones would be thousands of files

test_site::TerrainParameters terrain_of(const AnnotateOptions& o) {
  test_site::TerrainParameters p;
  p.size_x_m = o.size_m.at(0);
  p.size_y_m = o.size_m.at(1);
  return p;
}

Eigen::Vector2d size_of(const AnnotateOptions& o) { return {o.size_m.at(0), o.size_m.at(1)}; }

/// Draws a site like that of an annotation, on a ground like its own unless there is one.
void add_site_like(const AnnotateOptions& o, const sites::DrawOptions& draw, AnnotatedSite& out) {
  require(o.site.density == 0, "annotate: --like takes the densities of the site, so no --density");
  const primitives::Annotation site = primitives::read_annotation(o.like);
  const elements::Model ground = read_ground(site.ground);
  out.inputs.insert(out.inputs.end(), {o.like, site.ground});
  try {
    const sites::SiteModel learnt = sites::fit_site(primitives::GroundSurface(ground), site.objects,
                                                    o.measure.cell_m, draw.seed);
    if (out.has_own_ground) {
      out.ground = sites::ground_like(ground, size_of(o), o.ground_spacing_m, draw.seed);
    }
    out.drawn = sites::draw_site(learnt, primitives::GroundSurface(out.ground), draw);
    if (o.draws > 1) {
      out.statistics = sites::compare_with_draws(learnt, ground, site.objects, o.draws, draw.seed);
    }
  } catch (const DataError& e) {
    throw FormatError(o.like, "", e.what());
  }
}

/// Generates the objects of a site, and its ground unless there is one.
void add_generated(const AnnotateOptions& o, AnnotatedSite& out) {
  sites::GenerateOptions site = o.site;
  if (!o.primitives.empty()) {
    const NamedSet set = primitives_named(o.primitives, site.seed);
    site.classes = sites::classes_of(set.set);
    out.inputs = set.inputs;
  }
  if (!o.like.empty()) {
    add_site_like(o, {site.seed, site.margin_m, site.classes}, out);
  } else {
    site.kind = o.generate;
    site.patch_cell_m = o.measure.cell_m;
    if (out.has_own_ground) {
      out.ground = sites::generated_ground(size_of(o), o.ground_spacing_m, site.seed);
    }
    out.drawn = sites::generate_objects(primitives::GroundSurface(out.ground), site);
  }
  out.measured.objects = std::move(out.drawn->objects);
}

}  // namespace

// long: the table of the options.
std::span<const Option<AnnotateOptions>> annotate_options() {
  using O = AnnotateOptions;
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> all = sites::site_kinds();
    all.emplace_back(kLike);
    return all;
  }();
  // clang-format off
  static const Option<O> kOptions[] = {
    {"generate", "Generated site", "",
     "Generate a site of this kind instead of reading a log; like = one similar to that of --like",
     [](O& o) -> auto& { return o.generate; }, -kNoLimit, kNoLimit, {kinds.begin(), kinds.end()}},
    {"like", "Generated site", "",
     "Generate a site with the densities, sizes, distances and ground of the site of this annotation",
     [](O& o) -> auto& { return o.like; }, -kNoLimit, kNoLimit, {}, "SITE.json"},
    {"primitives", "Generated site", "",
     "Generate only objects of the classes that this set of primitives has",
     [](O& o) -> auto& { return o.primitives; }, -kNoLimit, kNoLimit, {}, "PRIMITIVES"},
    {"density", "Generated site", "",
     "Number of trees (in a meadow: of shrubs) per m²; 0 = 0.05 for a forest, 0.003 for a savanna, "
     "0.01 for a meadow",
     [](O& o) -> auto& { return o.site.density; }, 0, 10},
    {"margin", "Generated site", "m", "Width of the border of the ground that stays empty",
     [](O& o) -> auto& { return o.site.margin_m; }, 0, 10000},
    {"size", "Generated site", "m", "Length and width of a generated ground",
     [](O& o) -> auto& { return o.size_m; }, 1, 20000, {}, "X Y", 2},
    {"parts", "Generated site", "m",
     "Divide the site into squares of this side; each gets an annotation and a ground, and memory "
     "holds one row of squares; 0 = one annotation",
     [](O& o) -> auto& { return o.part_m; }, 0, 20000},

    {"draws", "More options", "",
     "With --like: number of random sites on the ground of SITE from which the intervals of its "
     "statistics are computed; 0 or 1 = no statistics",
     [](O& o) -> auto& { return o.draws; }, 0, 1000},
    {"ground-spacing", "More options", "m",
     "Side of the triangles of a generated ground; a ground fitted to the log has nodes at half this "
     "distance",
     [](O& o) -> auto& { return o.ground_spacing_m; }, 0.05, 100},
    {"box-quantile", "More options", "",
     "Fit each box to the points between the quantiles X and 1 − X along each axis; 0 = all points",
     [](O& o) -> auto& { return o.measure.quantile; }, 0, 0.49},
    {"patch-cell", "More options", "m", "Side of the cells that patches of shrubs are cut into",
     [](O& o) -> auto& { return o.measure.cell_m; }, 0.05, 1000},
    {"min-points", "More options", "", "Leave out objects and cells with fewer points",
     [](O& o) -> auto& { return o.measure.min_points; }, 1, kNoLimit},
  };
// clang-format on
return kOptions;
}

AnnotatedSite annotate_site(const std::string& file, BeamSource* log, const std::string& ground,
                            const AnnotateOptions& options,
                            const std::function<void(std::string_view, size_t, size_t)>& progress) {
  check_options("annotate", annotate_options(), options);
  const bool is_like = options.generate.empty() || options.generate == kLike;
  require(is_like || options.like.empty(), "annotate: give --generate KIND or --like SITE");
  require(options.generate != kLike || !options.like.empty(),
          "annotate: --generate needs a kind, or --like SITE");
  require((log == nullptr) != (options.generate.empty() && options.like.empty()),
          "annotate: give a labelled log, --generate KIND, or --like SITE");
  require(log == nullptr || options.primitives.empty(),
          "annotate: --primitives goes with a generated site");
  require(options.size_m.size() == 2, "annotate: size is a length and a width");
  require(options.part_m == 0, "annotate: parts are those of a generated site");
  const auto stage = [&](std::string_view name) -> primitives::MeasureProgress {
    if (!progress) return {};
    return [&progress, name](size_t done, size_t total) { progress(name, done, total); };
  };
  AnnotatedSite out;
  out.has_own_ground = ground.empty();
  if (!ground.empty()) out.ground = read_ground(ground);
  if (!log) {
    add_generated(options, out);
    return out;
  }
  primitives::require_objects(file, *log);
  if (out.has_own_ground) {
    out.ground = primitives::ground_of_log(file, *log, options.ground_spacing_m, stage("ground"));
  }
  out.measured = primitives::measure_objects(*log, primitives::GroundSurface(out.ground),
                                             options.measure, stage("annotate"));
  return out;
}

regions::GeneratedSite generate_parts(const std::filesystem::path& output,
                                      const AnnotateOptions& options, const std::string& provenance,
                                      const regions::PartProgress& progress) {
  check_options("annotate", annotate_options(), options);
  require(!options.generate.empty() && options.like.empty() && options.primitives.empty(),
          "annotate: parts are those of a site of a kind, without --like and --primitives");
  require(options.part_m >= kLeastPartM, "annotate: parts are at least 10 m wide");
  sites::GenerateOptions site = options.site;
  site.kind = options.generate;
  site.patch_cell_m = options.measure.cell_m;
  return regions::generate_site(output, terrain_of(options), options.ground_spacing_m,
                                sites::kGroundNoiseM, site, options.part_m, provenance, progress);
}

}  // namespace underbrush::pipeline
