#include <fmt/format.h>

#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/plants.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace meshes_verb {

struct Arguments {
  std::vector<std::string> plants;
  std::string output, up = "z";
  double variation = 1;
  pipeline::PlantFileOptions files;
  primitives::MeshPrimitiveOptions meshes;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("PLANTS", a.plants,
                 "Plant meshes (.obj, .ply, .gltf, .glb), folders of them, or the word generated "
                 "for the plants of the demo's site")
      ->required();
  verb.output("-o,--output", a.output, "The folder of the set of primitives")
      ->required()
      ->type_name("PRIMITIVES");
  app.add_option("--variation", a.variation,
                 "With generated: vary the demo's species by multiplying crown radius and base, "
                 "trunk, leaf area and leaf size by factors from 1/F to F")
      ->check(CLI::Range(1.0, 2.0))
      ->type_name("F")
      ->capture_default_str();
  app.add_option("--unit", a.files.unit_m, "Length of the files' unit, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--up", a.up, "Axis that points up in the files")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  app.add_option("--sizes", a.meshes.sizes_per_class,
                 "Number of heights of each plant in each class")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--most-scaling", a.meshes.most_scaling,
                 "Scale a plant by at most this factor, up or down")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  app.add_option("--patch-cell", a.meshes.cell_m, "Side of the cells of patches of shrubs, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--range-noise", a.meshes.range_sigma_m,
                 "Standard deviation of the noise on ranges, m")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void run(const Verb& verb, Arguments& a) {
  primitives::check_primitives_output(a.output);
  a.files.y_up = a.up == "y";
  a.meshes.seed = verb.seed;
  std::vector<primitives::PlantSource> plants;
  std::vector<std::filesystem::path> inputs;
  for (const std::string& name : a.plants) {
    const bool generated = name == "generated";
    auto some = generated ? pipeline::generated_plants(verb.seed, a.variation)
                          : pipeline::plants_of_files(name, a.files);
    for (auto& plant : some) {
      if (!generated) inputs.emplace_back(plant.name);
      plants.push_back(std::move(plant));
    }
  }
  const std::vector<primitives::Primitive> set = primitives::mesh_primitives(plants, a.meshes);
  primitives::write_primitives(a.output, set, a.meshes.cell_m, provenance(verb, inputs));
  // Number of primitives and triangles of each class.
  std::map<elements::Class, std::pair<size_t, size_t>> classes;
  size_t triangles = 0;
  for (const auto& p : set) {
    ++classes[p.label].first;
    classes[p.label].second += p.model.size();
    triangles += p.model.size();
  }
  Json j;
  j["plants"] = plants.size();
  j["primitives"] = set.size();
  j["triangles"] = triangles;
  std::string text = fmt::format("{} primitives of {} plants, {} triangles\n", set.size(),
                                 plants.size(), triangles);
  for (const auto& [label, n] : classes) {
    const std::string name(elements::name(label));
    j["classes"][name] = {{"primitives", n.first}, {"triangles", n.second}};
    text += fmt::format("  {:<19}{:>8}, {:.0f} triangles each\n", name, n.first,
                        double(n.second) / double(n.first));
  }
  double least = 1, most = 1;
  for (const auto& p : set) {
    for (const primitives::PlantPlacement& plant : p.plants) {
      least = std::min(least, plant.scale);
      most = std::max(most, plant.scale);
    }
  }
  j["scale"] = {least, most};
  j["range_noise_m"] = a.meshes.range_sigma_m;
  text += fmt::format(
      "  each plant is moved to its foot, turned to its longer axis and scaled by {:.3g} to "
      "{:.3g}, "
      "with noise of {:g} m;\n  primitive.json records this; a scene keeps its places with "
      "`underbrush simulate FILE`\n",
      least, most, a.meshes.range_sigma_m);
  text += "  primitives  " + a.output + "\n  to look at  " +
          (std::filesystem::path(a.output) / "index.html").string() + "\n";
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
  add_options(*verb, *a);
}

}  // namespace underbrush::app
