#include "underbrush/pipeline/compose_scene.hpp"

#include <chrono>

#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/mesh_set.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/primitives/leave_out.hpp"
#include "underbrush/regions/compose_world.hpp"

namespace underbrush::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr const char* kMeshPrimitives = "mesh_primitives";

primitives::Choice choice_of(const std::string& name) {
  if (name == "box") return primitives::Choice::kBox;
  return name == "best" ? primitives::Choice::kBest : primitives::Choice::kRandom;
}

void require_all_placed(const std::string& annotation, const std::string& primitives,
                        const primitives::Composition& c) {
  if (c.off_ground) {
    throw FormatError(annotation, "",
                      std::to_string(c.off_ground) + " objects stand off the ground mesh");
  }
  for (const auto& counts : {c.left_out, c.borrowed}) {
    if (counts.empty()) continue;
    throw FormatError(primitives, "",
                      "no primitives of the class " + counts.begin()->first + ", which " +
                          std::to_string(counts.begin()->second) + " objects have");
  }
}

primitives::ComposeOptions placement_of(const ComposeOptions& o) {
  check_options("compose", compose_options(), o);
  return {o.seed, choice_of(o.choose), o.nearest, o.scale,
          primitives::densities_of(o.class_density)};
}

/// Begins a scene: leaves out the primitives that the options say.
ComposedScene begun(const std::string& annotation, NamedSet& primitives,
                    const ComposeOptions& options) {
  ComposedScene out;
  out.warnings = primitives.warnings;
  out.inputs.emplace_back(annotation);
  out.inputs.insert(out.inputs.end(), primitives.inputs.begin(), primitives.inputs.end());
  for (const std::string& file : options.leave_out) {
    out.primitives_left_out += primitives::leave_out(
        primitives.set, primitives::read_annotation(file, options.allow_outside).objects);
    out.inputs.emplace_back(file);
  }
  return out;
}

double composing_s(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::span<const Option<ComposeOptions>> compose_options() {
  using O = ComposeOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"choose", "", "",
     "How the primitive of an object is chosen in its class: box = the nearest box; best = the "
     "best fit to the object's points and beams; it is adapted to them, and no plant is repeated "
     "within 20 m if others fit; random = a random one",
     [](O& o) -> auto& { return o.choose; }, -kNoLimit, kNoLimit, {"box", "best", "random"}},
    {"nearest", "", "", "Choose each primitive at random among the N best ones",
     [](O& o) -> auto& { return o.nearest; }, 1, kNoLimit},
    {"scale", "", "", "Scale each primitive to the box of its object",
     [](O& o) -> auto& { return o.scale; }},
    {"class-density", "", "",
     "Number of objects for each annotated object of a class: a factor below 1 leaves some out, "
     "above 1 adds more",
     [](O& o) -> auto& { return o.class_density; }, -kNoLimit, kNoLimit, {}, "CLASS=FACTOR ..."},
    {"leave-out", "", "",
     "Use no primitive that was cut from an object whose box overlaps one of this annotation, as "
     "seen from above",
     [](O& o) -> auto& { return o.leave_out; }, -kNoLimit, kNoLimit, {}, "ANNOTATION ..."},
    {"allow-outside", "", "", kAllowOutsideHelp,
     [](O& o) -> auto& { return o.allow_outside; }},
    {"strict", "", "", "Fail if an object cannot be placed as annotated",
     [](O& o) -> auto& { return o.strict; }},
  };
// clang-format on
return kOptions;
}

NamedSet primitives_named(const std::string& name, uint64_t seed) {
  if (name != kMeshPrimitives) return {name, primitives::read_primitive_set(name), {name}};
  MeshesOptions options;
  options.meshes.seed = seed;
  NamedSet out{name, primitives::primitive_set(mesh_set({"generated"}, options).primitives,
                                               options.meshes.cell_m)};
  if (fs::exists(fs::path(name) / "primitives.json")) {
    out.warnings.push_back(
        name + " is the set of the generated plants; the folder of that name is ./" + name);
  }
  return out;
}

primitives::Composition compose_scene(const primitives::Annotation& site,
                                      const elements::Model& ground,
                                      const primitives::PrimitiveSet& primitives,
                                      const ComposeOptions& options,
                                      const primitives::ComposeProgress& progress) {
  const primitives::ComposeOptions placement = placement_of(options);
  require_data(ground.ground.size() > 0, "compose: the model has no ground");
  return primitives::compose(site, ground, primitives, placement, progress);
}

ComposedScene compose_scene(const std::string& annotation, NamedSet primitives,
                            const elements::Model* ground, const std::string& ground_folder,
                            const ComposeOptions& options,
                            const primitives::ComposeProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  check_options("compose", compose_options(), options);
  const primitives::Annotation site =
      primitives::read_annotation(annotation, options.allow_outside);
  ComposedScene out = begun(annotation, primitives, options);
  elements::Model read;
  if (!ground) {
    const fs::path from =
        ground_folder.empty() ? site.ground.lexically_normal() : fs::path(ground_folder);
    read = read_ground(from);
    out.inputs.push_back(from);
    ground = &read;
  }
  out.composition = compose_scene(site, *ground, primitives.set, options, progress);
  if (options.strict) require_all_placed(annotation, primitives.name, out.composition);
  out.seconds = composing_s(start);
  return out;
}

ComposedScene compose_parts(
    const fs::path& output, const std::string& site, NamedSet primitives,
    const ComposeOptions& options,
    const std::function<std::string(const std::vector<fs::path>&)>& provenance,
    const primitives::ComposeProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const primitives::ComposeOptions placement = placement_of(options);
  ComposedScene out = begun(site, primitives, options);
  const auto accept = [&](const primitives::Composition& c) {
    if (options.strict) require_all_placed(site, primitives.name, c);
  };
  out.composition =
      regions::compose_world(output, regions::read_site(site), primitives.set, placement,
                             options.allow_outside, provenance(out.inputs), accept, progress);
  out.seconds = composing_s(start);
  return out;
}

}  // namespace underbrush::pipeline
