#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/library/library.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace primitives_verb {

struct Arguments {
  std::string action, output;
  std::vector<std::string> sets;
  library::Options options;
};

void list(const Verb& verb, const Arguments& a) {
  require(a.sets.size() == 1, "primitives: list takes one set");
  const std::vector<library::Found> found =
      library::find_primitives(primitives::read_primitive_set(a.sets[0]), a.options);
  Json j{{"primitives", Json::array()}};
  std::string text = fmt::format("{} primitives\n", found.size());
  for (const library::Found& f : found) {
    j["primitives"].push_back({{"folder", f.name},
                               {"height_m", f.height_m},
                               {"width_m", f.width_m},
                               {"site", f.origin.site},
                               {"season", f.origin.season},
                               {"sensor", f.origin.sensor},
                               {"license", f.origin.license},
                               {"name", f.given_name}});
    text += wide_line(24, f.name, "{:6.2f} m high {:6.2f} m wide  {} {} {}{}", f.height_m,
                      f.width_m, f.origin.site, f.origin.season, f.origin.sensor,
                      f.given_name.empty() ? "" : " \"" + printable(f.given_name) + "\"");
  }
  verb.report(j, text);
}

void run(const Verb& verb, const Arguments& a) {
  if (a.action == "list") return list(verb, a);
  require(!a.output.empty(), "primitives: merge needs an output (-o)");
  primitives::check_primitives_output(a.output);
  const std::vector<std::filesystem::path> folders(a.sets.begin(), a.sets.end());
  std::vector<std::filesystem::path> inputs = folders;
  inputs.emplace_back(a.options.edits);
  const library::Merged merged = library::merge_sets(folders, a.options);
  primitives::write_primitives(a.output, merged.primitives, merged.cell_m, provenance(verb, inputs),
                               merged.origins);
  const std::string text =
      fmt::format("{} primitives of {} sets\n", merged.primitives.size(), merged.origins.size()) +
      left_out(merged.edits.thrown_out, "that are thrown out") +
      left_out(merged.not_wanted, "that are not searched for") +
      (a.options.edits.empty() ? ""
                               : line("edits", "{} of another class, {} named",
                                      merged.edits.relabelled, merged.edits.named)) +
      line("duplicates", "{} {}", merged.duplicates,
           a.options.keep_duplicates ? "kept" : "left out") +
      (merged.without_license ? line("warning", "{} sets have no licence", merged.without_license)
                              : "");
  verb.report({{"primitives", merged.primitives.size()},
               {"origins", merged.origins.size()},
               {"thrown_out", merged.edits.thrown_out},
               {"relabelled", merged.edits.relabelled},
               {"named", merged.edits.named},
               {"not_wanted", merged.not_wanted},
               {"duplicates", merged.duplicates},
               {"without_license", merged.without_license}},
              text + lines_of_set(a.output));
}

}  // namespace primitives_verb
}  // namespace

void add_primitives(Program& program) {
  using namespace primitives_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Scenes", "primitives", "Merge sets of primitives, or search in them",
               "underbrush primitives merge a/ b/ --of-site creek meadow --of-license CC-BY-4.0 -o "
               "library/\n"
               "  underbrush primitives list library/ --class tree --min-height 4 --season summer\n"
               "  underbrush primitives merge library/ --class shrub --edits edits.json -o shrubs/",
               [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("ACTION", a->action, "merge or list")
      ->required()
      ->check(CLI::IsMember({"merge", "list"}));
  verb->app.add_option("SETS", a->sets, "Folders of sets of primitives, or of libraries")
      ->required();
  verb->output("-o,--output", a->output, "The folder of the library")->type_name("PRIMITIVES");
  add_options(*verb, library::options(), a->options, "Search");
}

}  // namespace underbrush::app
