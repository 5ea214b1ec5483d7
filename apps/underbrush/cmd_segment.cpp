#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "cli/progress.hpp"
#include "labelled_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/primitives/given_labels.hpp"
#include "underbrush/primitives/segment_log.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace segment_verb {

using elements::Class;

struct Arguments {
  std::string log, output, labels, truth = "instance";
  primitives::GivenLabelOptions given;
  primitives::SegmentLogOptions segment;
};

void add_object_options(Verb& verb, primitives::ObjectOptions& o) {
  CLI::App& app = verb.app;
  const auto option = [&](const char* name, double& value, const char* text) {
    app.add_option(name, value, text)->check(CLI::NonNegativeNumber)->capture_default_str();
  };
  option("--cell", o.cell_m, "Side of a column, m; 0 = 0.4, more where points are sparse");
  option("--gap", o.gap_m,
         "Empty height that separates objects in a column, m; 0 = by the column's side");
  app.add_option("--min-points", o.min_points, "Least number of points of an object")
      ->capture_default_str();
  verb.begin_rare_group("Trees");
  option("--spacing", o.spacing_a_m,
         "Treat peaks nearer to each other than this as one crown, m; grows with height");
  option("--prominence", o.prominence_a_m,
         "Join crowns whose dip between them is less deep than this, m; grows with height");
  option("--radius", o.radius_a_m, "Largest reach of a crown from its peak, m; grows with height");
  option("--foot", o.trunk_m, "Largest width of a tree's foot under its crown, m");
  verb.begin_rare_group("Classes by size");
  option("--tree-height", o.sizes.tree_m, "Least height of a tree, m; lower objects are shrubs");
  option("--small-shrub-height", o.sizes.small_shrub_m,
         "Least height of a small shrub, m; lower ones are low shrubs");
  option("--medium-tree-height", o.sizes.medium_tree_m,
         "Least height of a medium tree, m; lower ones are small trees");
  option("--large-tree-height", o.sizes.large_tree_m,
         "Least height of a large tree, m; lower ones are medium trees at most");
  option("--patch-side", o.sizes.patch_m, "Least length of a patch of shrubs, m");
}

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log (ray cloud PLY, as import writes it)")->required();
  verb.output("-o,--output", a.output,
              "The log with the columns class and instance; columns of these names that it has "
              "already are kept as given_class and given_instance, for comparison")
      ->type_name("LABELLED.ply");
  app.add_option("--labels", a.labels,
                 "Take labels from this file: a SemanticKITTI .label file, or a PLY, PCD or CSV "
                 "file with a column class or instance (also the log itself)")
      ->type_name("FILE");
  app.add_option("--label-set", a.given.set,
                 "Label set that gives the numbers of --labels their meaning")
      ->check(CLI::IsMember(elements::label_set_names()));
  app.add_option("--truth", a.truth,
                 "Column of the log with the numbers of the true trees, to score against")
      ->capture_default_str();
  app.add_option("--ground-method", a.segment.ground.method, "Method of ground segmentation")
      ->check(CLI::IsMember({"lower_envelope", "spherical_variance"}))
      ->capture_default_str();
  app.add_option("--min-range", a.segment.min_range_m,
                 "Ignore hits nearer than this, m, such as those on the own vehicle")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb.begin_rare_group("Objects");
  app.add_option("--tile", a.segment.tile_m, "Side of a tile of the ground segmentation, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_object_options(verb, a.segment.objects);
}

/// Adds what the search found to the results.
void add_objects(const primitives::LogLabels& labels, Json& j) {
  std::map<Class, size_t> objects;
  for (const auto& object : labels.objects) ++objects[object.label];
  for (const auto& [c, n] : objects) j["classes"][std::string(elements::name(c))] = n;
  j["cell_m"] = labels.cell_m;
  j["off_ground"] = labels.off_ground;
  j["near"] = labels.near;
}

void run(const Verb& verb, const Arguments& a) {
  io::LogReader log(a.log);
  if (!a.output.empty()) io::check_output(a.output);
  std::optional<primitives::GivenLabels> given;
  std::optional<primitives::LogLabels> labels;
  if (!a.labels.empty()) given = primitives::read_given_labels(a.labels, log, a.given);
  // Labels of our own set with instances need no search.
  const bool whole =
      given && given->set == "underbrush" && !given->label.empty() && !given->instance.empty();
  if (!whole) {
    StageProgress progress;
    labels = primitives::segment_log(
        log, a.segment,
        given && !given->label.empty() ? priors_of(*given) : std::vector<primitives::Prior>{},
        std::ref(progress));
  }
  const LabelsOfHits found =
      given ? taken_over(*given, labels ? &*labels : nullptr) : found_of(*labels);

  std::vector<std::filesystem::path> inputs{a.log};
  if (given) inputs.emplace_back(a.labels);
  LabelledSource labelled(log, found, LabelledCounts(a.truth, a.labels.empty()));
  std::optional<io::LogWriter> writer;
  if (!a.output.empty()) writer.emplace(a.output, labelled.info(), provenance(verb, inputs));
  for (BeamLog chunk; labelled.next(chunk);) {
    if (writer) writer->write(chunk);
  }
  if (writer) writer->close();
  const LabelledCounts& out = labelled.counts();
  std::string text = text_of(out, found.objects);
  Json j = json_of(out);
  j["ground_method"] = a.segment.ground.method;
  j["objects"] = found.objects;
  j["skipped"] = log.skipped();
  if (labels) add_objects(*labels, j);
  if (given) {
    j["labels"] = {{"set", given->set},
                   {"by_place", given->by_place},
                   {"unmatched", given->unmatched},
                   {"not_numbers", given->not_numbers}};
    text += fmt::format("  labels      {} ({}), {} hits without\n", a.labels,
                        given->by_place ? "by place" : "by order", given->unmatched);
  }
  if (labels && labels->off_ground) {
    text += fmt::format("  left out    {} hits with no ground within 30 m: in no object\n",
                        labels->off_ground);
  }
  if (writer) text += "  log         " + a.output + "\n";
  verb.report(j, text);
}

}  // namespace segment_verb
}  // namespace

void add_segment(Program& program) {
  using namespace segment_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Scenes", "segment",
               "Label a log as ground, trees, shrubs and patches, or take labels from a file",
               "underbrush segment log.ply -o labelled.ply\n"
               "  underbrush segment log.ply --labels edited.ply -o labelled.ply\n"
               "  underbrush segment log.ply --ground-method spherical_variance --json -",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
