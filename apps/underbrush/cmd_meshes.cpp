#include <map>

#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "underbrush/pipeline/mesh_set.hpp"
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
  // Number of primitives and triangles of each class.
  std::map<elements::Class, std::pair<size_t, size_t>> classes;
  size_t triangles = 0;
  double least = 1, most = 1;
  for (const primitives::Primitive& p : set.primitives) {
    ++classes[p.label].first;
    classes[p.label].second += p.model.size();
    triangles += p.model.size();
    for (const primitives::PlantPlacement& plant : p.plants) {
      least = std::min(least, plant.scale);
      most = std::max(most, plant.scale);
    }
  }
  Json j{{"plants", set.plants}, {"primitives", set.primitives.size()}, {"triangles", triangles}};
  std::string text = fmt::format("{} primitives of {} plants, {} triangles\n",
                                 set.primitives.size(), set.plants, triangles);
  for (const auto& [label, n] : classes) {
    const std::string name(elements::name(label));
    j["classes"][name] = {{"primitives", n.first}, {"triangles", n.second}};
    text += wide_line(18, name, "{:>8}, {:.0f} triangles each", n.first,
                      double(n.second) / double(n.first));
  }
  j["scale"] = {least, most};
  j["range_noise_m"] = a.options.meshes.range_sigma_m;
  text += fmt::format(
      "  each plant is moved to its foot, turned to its longer axis and scaled by {:.3g} to "
      "{:.3g}, with noise of {:g} m;\n  primitive.json records this; a scene keeps its places with "
      "`underbrush simulate FILE`\n",
      least, most, a.options.meshes.range_sigma_m);
  text += line("primitives", "{}", a.output);
  text += line("to look at", "{}", (std::filesystem::path(a.output) / "index.html").string());
  verb.report(j, text);
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
