#include "underbrush/pipeline/annotate_site.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/log_ground.hpp"
#include "underbrush/test_site/terrain.hpp"

namespace underbrush::pipeline {
namespace {

constexpr double kGroundNoiseM = 0.03;  // m; standard deviation of ranges on a generated ground

test_site::TerrainParameters terrain_of(const AnnotateOptions& o) {
  require(o.size_m.size() == 2, "annotate: size is a length and a width");
  test_site::TerrainParameters p;
  p.size_x_m = o.size_m[0];
  p.size_y_m = o.size_m[1];
  return p;
}

elements::Model generated_ground(const AnnotateOptions& o) {
  elements::Model model;
  model.ground = test_site::Terrain(terrain_of(o), o.site.seed).mesh(o.ground_spacing_m, 0);
  model.ground.range_sigma_m = kGroundNoiseM;
  model.fitter = "generated_ground";
  return model;
}

primitives::GenerateOptions site_of(const AnnotateOptions& o) {
  primitives::GenerateOptions site = o.site;
  site.kind = o.generate;
  site.patch_cell_m = o.measure.cell_m;
  return site;
}

}  // namespace

// long: the table of the options.
std::span<const Option<AnnotateOptions>> annotate_options() {
  using O = AnnotateOptions;
  static const std::vector<std::string> kinds = primitives::site_kinds();
  // clang-format off
  static const Option<O> kOptions[] = {
    {"generate", "Generated site", "", "Generate a site of this kind instead of reading a log",
     [](O& o) -> auto& { return o.generate; }, -kNoLimit, kNoLimit, {kinds.begin(), kinds.end()}},
    {"density", "Generated site", "",
     "Trees (in a meadow: shrubs) per m²; 0 = forest 0.05, savanna 0.003, meadow 0.01",
     [](O& o) -> auto& { return o.site.density; }, 0, 10},
    {"margin", "Generated site", "m", "Width of the border of the ground that stays empty",
     [](O& o) -> auto& { return o.site.margin_m; }, 0, 10000},
    {"size", "Generated site", "m", "Length and width of a generated ground",
     [](O& o) -> auto& { return o.size_m; }, 1, 20000, {}, "X Y", 2},
    {"parts", "Generated site", "m",
     "Write a folder of square parts of this side, each an annotation with its ground, in the memory "
     "of a row of parts; 0 = one annotation",
     [](O& o) -> auto& { return o.part_m; }, 0, 20000},

    {"ground-spacing", "More options", "m",
     "Side of the triangles of a generated ground; a ground fitted to the log has nodes at half this "
     "distance",
     [](O& o) -> auto& { return o.ground_spacing_m; }, 0.05, 100},
    {"box-quantile", "More options", "",
     "Fit boxes to the points from this quantile to 1 − it along each axis; 0 = all points",
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
  require((log == nullptr) != options.generate.empty(),
          "annotate: give a labelled log, or --generate KIND");
  require(options.part_m == 0, "annotate: parts are those of a generated site");
  const auto stage = [&](std::string_view name) -> primitives::MeasureProgress {
    if (!progress) return {};
    return [&progress, name](size_t done, size_t total) { progress(name, done, total); };
  };
  if (log) primitives::require_objects(file, *log);
  AnnotatedSite out;
  out.has_own_ground = ground.empty();
  out.ground =
      !ground.empty() ? read_ground(ground)
      : log ? primitives::ground_of_log(file, *log, options.ground_spacing_m, stage("ground"))
            : generated_ground(options);
  const primitives::GroundSurface surface(out.ground);
  if (log) {
    out.measured = primitives::measure_objects(*log, surface, options.measure, stage("annotate"));
  } else {
    out.measured.objects = primitives::generate_objects(surface, site_of(options));
  }
  return out;
}

regions::GeneratedSite generate_parts(const std::filesystem::path& output,
                                      const AnnotateOptions& options, const std::string& provenance,
                                      const regions::PartProgress& progress) {
  check_options("annotate", annotate_options(), options);
  require(!options.generate.empty(), "annotate: parts are those of a generated site");
  return regions::generate_site(output, terrain_of(options), options.ground_spacing_m,
                                kGroundNoiseM, site_of(options), options.part_m, provenance,
                                progress);
}

void write_annotated(const std::filesystem::path& output, const std::filesystem::path& ground,
                     AnnotatedSite site, const std::string& provenance) {
  const primitives::Annotation annotation{ground, std::move(site.measured.objects), provenance};
  if (!site.has_own_ground) return primitives::write_annotation(output, annotation);
  site.ground.provenance = provenance;
  io::AtomicFile folder(ground, io::OutputKind::kFolder);
  elements::write_model(folder.temporary(), site.ground);
  primitives::write_annotation(output, annotation);
  folder.commit();
}

}  // namespace underbrush::pipeline
