#include <fmt/format.h>

#include <algorithm>

#include "cli/progress.hpp"
#include "objects_of_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace extract_verb {

constexpr size_t kPoor = 3;  // elements

struct Arguments {
  std::string model, log, output, membership = "own";
  primitives::ExtractOptions extract;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("MODEL", a.model, "The model's folder")->required();
  app.add_option("LABELLED", a.log, "The log that the model was fitted to, labelled by segment")
      ->required();
  verb.output("-o,--output", a.output, "The folder of the set of primitives")
      ->required()
      ->type_name("PRIMITIVES");
  verb.begin_rare_group();
  app.add_option("--box-quantile", a.extract.measure.quantile,
                 "Fit boxes to the points from this quantile to 1 − it along each axis; 0 = all "
                 "points (0.05 in the code of [tallavajhula18]'s authors)")
      ->check(CLI::Range(0.0, 0.49))
      ->capture_default_str();
  app.add_option("--elements", a.membership,
                 "Elements that an object takes: all those centred in its box, or only its own, "
                 "which lie among its points")
      ->check(CLI::IsMember({"own", "box"}))
      ->capture_default_str();
  app.add_option("--free-space-below", a.extract.free_space_below,
                 "Leave out ellipsoids at which a smaller share of the beams that met them ended")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--patch-cell", a.extract.measure.cell_m,
                 "Side of the cells that patches of shrubs are cut into, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--min-elements", a.extract.min_elements,
                 "Leave out objects and cells with fewer elements")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--min-points", a.extract.measure.min_points,
                 "Leave out objects and cells with fewer points")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

std::string note_of_poor(const std::vector<primitives::Primitive>& primitives) {
  const auto poor = std::count_if(primitives.begin(), primitives.end(),
                                  [](const auto& p) { return p.model.size() < kPoor; });
  if (poor == 0) return "";
  return fmt::format(
      "  note: {} of them have fewer than {} elements and hardly look like a plant; "
      "--min-elements leaves such out\n",
      poor, kPoor);
}

void run(const Verb& verb, Arguments& a) {
  const elements::Model model = elements::read_model(a.model);
  io::BeamReader log(a.log);
  primitives::check_primitives_output(a.output);
  a.extract.membership =
      a.membership == "box" ? primitives::Membership::kBox : primitives::Membership::kOwn;
  require_objects(a.log, log);
  if (model.ground.size() == 0) throw FormatError(a.model, "", "the model has no ground");
  primitives::ExtractResult result;
  {
    Progress progress("extract");
    result = primitives::extract(model, log, a.extract, std::ref(progress));
  }
  if (result.primitives.empty()) {
    throw FormatError(a.log, "", "none of its objects holds an element of the model");
  }
  primitives::write_primitives(a.output, result.primitives, a.extract.measure.cell_m,
                               provenance(verb, {a.model, a.log}));
  // Number of primitives and elements of each class.
  std::map<elements::Class, std::pair<size_t, size_t>> classes;
  for (const auto& p : result.primitives) {
    ++classes[p.label].first;
    classes[p.label].second += p.model.size();
  }
  const primitives::MeasuredObjects& m = result.measured;
  Json j;
  j["primitives"] = result.primitives.size();
  j["elements"] = result.elements;
  j["elements_taken"] = result.taken;
  j["free_space"] = result.free_space;
  j["empty"] = result.empty;
  j["few_elements"] = result.few_elements;
  j["few_points"] = m.few_points;
  j["off_ground"] = m.off_ground;
  j["hits_without_instance"] = m.without_instance;
  std::string text = fmt::format(
      "{} primitives hold {} of {} elements ({:.1f} %)\n", result.primitives.size(), result.taken,
      result.elements, 100.0 * double(result.taken) / double(std::max<size_t>(1, result.elements)));
  for (const auto& [label, n] : classes) {
    const std::string name(elements::name(label));
    j["classes"][name] = {{"primitives", n.first}, {"elements", n.second}};
    text += fmt::format("  {:<19}{:>8}, {:.0f} elements each\n", name, n.first,
                        double(n.second) / double(n.first));
  }
  text += note_of_poor(result.primitives);
  text += left_out({{"ellipsoids of free space", result.free_space},
                    {"objects without an element", result.empty},
                    {"objects or cells of few elements", result.few_elements},
                    {"objects or cells of few points", m.few_points},
                    {"objects off the ground", m.off_ground},
                    {"hits of an object's class without instance", m.without_instance}});
  text += "  primitives  " + a.output + "\n  to look at  " +
          (std::filesystem::path(a.output) / "index.html").string() + "\n";
  verb.report(j, text);
}

}  // namespace extract_verb
}  // namespace

void add_extract(Program& program) {
  using namespace extract_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "extract", "Cut primitives out of a model along a labelled log",
      "underbrush extract model/ labelled.ply -o primitives/", [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
