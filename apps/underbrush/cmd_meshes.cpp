#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace meshes_verb {

struct Arguments {
  std::vector<std::string> plants;
  std::string output;
  pipeline::MeshesOptions options;
};

void run(const Verb& verb, Arguments& a) {
  primitives::check_primitives_output(a.output);
  a.options.meshes.seed = verb.seed;
  const pipeline::MeshSet set = pipeline::mesh_set(a.plants, a.options);
  primitives::write_primitives(a.output, set.primitives, a.options.meshes.cell_m,
                               provenance(verb, set.inputs));
  const Json j = json_of(set, a.options);
  std::string text = fmt::format("{} primitives of {} plants, {} triangles\n",
                                 set.primitives.size(), set.plants, j["triangles"].get<size_t>());
  for (const auto& [name, n] : j["classes"].items()) {
    const auto primitives = n["primitives"].get<size_t>();
    text += wide_line(18, name, "{:>8}, {:.0f} triangles each", primitives,
                      n["triangles"].get<double>() / double(primitives));
  }
  text += fmt::format(
      "  each plant is moved to its foot, turned to its longer axis and scaled by {:.3g} to "
      "{:.3g}, with noise of {:g} m;\n  primitive.json records this; a scene keeps its places with "
      "`underbrush simulate FILE`\n",
      set.least_scale, set.most_scale, a.options.meshes.range_sigma_m);
  verb.report(j, text + lines_of_set(a.output));
}

}  // namespace meshes_verb
}  // namespace

void add_meshes(Program& program) {
  using namespace meshes_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Scenes", "meshes",
               "Make primitives from plant meshes, moved, turned and scaled, for composed scenes",
               "underbrush meshes generated -o meshes/\n"
               "  underbrush meshes plants/ fern.obj --up y -o meshes/\n"
               "  underbrush compose annotation.json meshes/ -o scene/",
               [a](const Verb& v) { run(v, *a); });
  verb->app
      .add_option("PLANTS", a->plants,
                  "Plant meshes (.obj, .ply, .gltf, .glb), folders of them, or the word generated "
                  "for the plants of the demo's site")
      ->required();
  verb->output("-o,--output", a->output, "The folder of the set of primitives")
      ->required()
      ->type_name("PRIMITIVES");
  add_options(*verb, pipeline::meshes_options(), a->options);
}

}  // namespace underbrush::app
