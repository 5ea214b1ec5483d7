#include <fmt/format.h>

#include <optional>

#include "cli/progress.hpp"
#include "objects_report.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/generate.hpp"
#include "underbrush/primitives/log_ground.hpp"
#include "underbrush/test_site/terrain.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {
namespace annotate_verb {

constexpr double kGroundNoiseM = 0.03;  // m; standard deviation of ranges on a generated ground

struct Arguments {
  std::string log, output, ground, kind;
  std::vector<double> size{200, 200};
  double spacing_m = 1;
  primitives::MeasureOptions measure;
  primitives::GenerateOptions generate;
  test_site::TerrainParameters terrain;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  auto* log = app.add_option("LABELLED", a.log, "The site's log, labelled by segment");
  verb.output("-o,--output", a.output, "The annotation file")
      ->required()
      ->type_name("ANNOTATION.json");
  app.add_option(
         "--ground", a.ground,
         "Model whose ground the objects stand on; by default the ground is made from the log's "
         "ground points, or generated, as the folder STEM.ground beside the annotation")
      ->type_name("MODEL");
  verb.begin_group("Generated site");
  auto* kind =
      app.add_option("--generate", a.kind, "Generate a site of this kind instead of reading a log")
          ->check(CLI::IsMember(primitives::site_kinds()));
  kind->excludes(log);
  app.add_option("--density", a.generate.density,
                 "Trees (in a meadow: shrubs) per m²; 0 = forest 0.05, savanna 0.003, meadow 0.01")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--margin", a.generate.margin_m,
                 "Width of the border of the ground that stays empty, m")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--size", a.size, "Length and width of a generated ground, m")
      ->expected(2)
      ->check(CLI::Range(1.0, 20000.0))
      ->type_name("X Y");
  verb.begin_rare_group();
  app.add_option("--ground-spacing", a.spacing_m,
                 "Side of the triangles of a generated ground, m; a ground fitted to the log has "
                 "nodes at half this distance")
      ->check(CLI::Range(0.05, 100.0))
      ->capture_default_str();
  app.add_option(
         "--box-quantile", a.measure.quantile,
         "Fit boxes to the points from this quantile to 1 − it along each axis; 0 = all points")
      ->check(CLI::Range(0.0, 0.49))
      ->capture_default_str();
  app.add_option("--patch-cell", a.measure.cell_m,
                 "Side of the cells that patches of shrubs are cut into, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--min-points", a.measure.min_points,
                 "Leave out objects and cells with fewer points")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

elements::Model generated_ground(const Arguments& a, uint64_t seed) {
  test_site::TerrainParameters p = a.terrain;
  p.size_x_m = a.size[0];
  p.size_y_m = a.size[1];
  elements::Model model;
  model.ground = test_site::Terrain(p, seed).mesh(a.spacing_m, 0);
  model.ground.range_sigma_m = kGroundNoiseM;
  model.fitter = "generated_ground";
  return model;
}

/// Writes the annotation, and a new ground beside it; either both appear or none.
void write(elements::Model* ground, const fs::path& output,
           const primitives::Annotation& annotation) {
  if (!ground) return primitives::write_annotation(output, annotation);
  ground->provenance = annotation.provenance;
  io::AtomicFile folder(annotation.ground, io::OutputKind::kFolder);
  elements::write_model(folder.temporary(), *ground);
  primitives::write_annotation(output, annotation);
  folder.commit();
}

void run(const Verb& verb, Arguments& a) {
  if (a.log.empty() == a.kind.empty()) {
    throw std::invalid_argument("annotate: give a labelled log, or --generate KIND");
  }
  const fs::path output = a.output;
  io::check_output(output);
  std::optional<io::LogReader> log;
  if (!a.log.empty()) {
    log.emplace(a.log);
    primitives::require_objects(a.log, *log);
  }
  primitives::Annotation annotation;
  annotation.ground = a.ground;
  std::vector<fs::path> inputs;
  if (log) inputs.emplace_back(a.log);
  elements::Model ground;
  if (!a.ground.empty()) {
    inputs.emplace_back(a.ground);
    ground = elements::read_model(a.ground);
    if (ground.ground.size() == 0) throw FormatError(a.ground, "", "the model has no ground");
  } else {
    annotation.ground = output.parent_path() / (output.stem().string() + ".ground");
    elements::check_model_output(annotation.ground);
    ground = log ? primitives::ground_of_log(a.log, *log, a.spacing_m, shown<Progress>("ground"))
                 : generated_ground(a, verb.seed);
  }
  annotation.provenance = provenance(verb, inputs);
  const primitives::GroundSurface surface(ground);
  primitives::MeasuredObjects measured;
  if (log) {
    measured = primitives::measure_objects(*log, surface, a.measure, shown<Progress>("annotate"));
  } else {
    a.generate.kind = a.kind;
    a.generate.seed = verb.seed;
    a.generate.patch_cell_m = a.measure.cell_m;
    measured.objects = primitives::generate_objects(surface, a.generate);
  }
  annotation.objects = measured.objects;
  write(a.ground.empty() ? &ground : nullptr, output, annotation);

  const Json j = json_of(measured);
  const std::string text =
      text_of(measured) + fmt::format("  ground      {} ({} triangles)\n  annotation  {}\n",
                                      annotation.ground.string(), ground.ground.size(), a.output);
  verb.report(j, text);
}

}  // namespace annotate_verb
}  // namespace

void add_annotate(Program& program) {
  using namespace annotate_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "annotate",
      "List the objects of a site, from a labelled log or generated at random",
      "underbrush annotate labelled.ply -o annotation.json\n"
      "  underbrush annotate --generate savanna --density 0.005 --seed 7 -o annotation.json\n"
      "  underbrush annotate --generate forest --ground model/ -o annotation.json",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
