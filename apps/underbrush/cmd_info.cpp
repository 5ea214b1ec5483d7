#include <fmt/format.h>

#include <iostream>
#include <map>

#include "cli/progress.hpp"
#include "fit_text.hpp"
#include "report/light_text.hpp"
#include "report/log_text.hpp"
#include "report/world_text.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/range_unit.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/metrics/leaf_cloud.hpp"
#include "underbrush/metrics/leaf_inclination.hpp"
#include "underbrush/pipeline/fit_json.inl"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace info_verb {

/// Adds what the index of a world of regions says to `j`, and returns it as text. No region is
/// read.
std::string text_of_regions(const std::string& path, const regions::WorldFolder& world, Json& j) {
  constexpr double kMiB = 1 << 20;
  Eigen::AlignedBox3d box;
  uint64_t memory = 0, largest = 0;
  for (const regions::Region& r : world.index().regions) {
    box.extend(r.bounds);
    memory += r.bytes();
    largest = std::max(largest, r.bytes());
  }
  const uint64_t bytes = io::size_of(path);
  j["regions"] = world.index().regions.size();
  j["side_m"] = world.index().side_m;
  j["bytes"] = bytes;
  j["memory_bytes"] = {{"common", world.common_bytes()}, {"regions", memory}, {"largest", largest}};
  std::string text = fmt::format(
      "  regions     {} of {:g} m, {:.0f} MiB on disk\n  memory      {:.0f} MiB for what they have "
      "in common, {:.0f} MiB for all regions, {:.1f} MiB for the largest (estimates)\n",
      world.index().regions.size(), world.index().side_m, double(bytes) / kMiB,
      double(world.common_bytes()) / kMiB, double(memory) / kMiB, double(largest) / kMiB);
  if (box.isEmpty()) return text;
  const Vec3 &low = box.min(), &high = box.max();
  j["bounds_m"] = {{"min", {low.x(), low.y(), low.z()}}, {"max", {high.x(), high.y(), high.z()}}};
  return text +
         fmt::format("  bounds      {:.1f} to {:.1f}, {:.1f} to {:.1f}, {:.1f} to {:.1f} m\n",
                     low.x(), high.x(), low.y(), high.y(), low.z(), high.z());
}

void report_model(const Verb& verb, const std::string& path, const pipeline::World& world) {
  const elements::Model& model = world.scene.models[0];
  Json j = pipeline::json_of_model(model);
  std::string table;
  const Json classes = j.value("classes", Json::object());
  for (const auto& [name, n] : classes.items()) {
    const uint32_t label = model.class_number(name).value_or(0);
    if (classes.size() == 1 && label == 0) break;  // no class is known
    table += fmt::format("  {:<19}{:>8} ellipsoids, grain {:.3f} m\n", name, n.get<size_t>(),
                         model.grain.side_at(model.grain.place_of(label)));
  }
  if (model.sway_s > 0) {
    table += fmt::format("  matter sways with a correlation time of {:.2g} s\n", model.sway_s);
  }
  table += report::text_of_light(model);
  if (world.regions) table += text_of_regions(path, *world.regions, j);
  verb.report(j, fmt::format("{}: model by {}: {} ground triangles, {} surface triangles, {} "
                             "ellipsoids\n  tau {:g}, ground sigma {:.3f} m, origin {:.1f} {:.1f} "
                             "{:.1f} m\n",
                             path, model.fitter, j["ground_triangles"].get<size_t>(),
                             j["surface_triangles"].get<size_t>(), j["ellipsoids"].get<size_t>(),
                             model.tau, model.ground.range_sigma_m, model.origin.x(),
                             model.origin.y(), model.origin.z()) +
                     text_of_channels(model.channels) + table);
}

// Returns a table of the objects of each class, and puts it into `j`.
std::string table_of_classes(const std::map<elements::Class, size_t>& classes, Json& j,
                             const elements::SceneInfo& info = {}) {
  std::string text;
  for (const auto& [c, n] : classes) {
    const std::string called = elements::class_name(info, c);
    j["classes"][called] = n;
    text += fmt::format("  {:<19}{:>8}\n", called, n);
  }
  return text;
}

void report_scene(const Verb& verb, const std::string& path, const pipeline::World& world) {
  const auto& [scene, info, read, regions] = world;
  size_t triangles = 0, ellipsoids = 0;
  for (const elements::Model& m : scene.models) {
    triangles += m.whole_count(elements::Kind::kSurface);
    ellipsoids += m.whole_count(elements::Kind::kEllipsoid);
  }
  const size_t ground = scene.models.at(0).whole_count(elements::Kind::kGround);
  const size_t instances = regions ? regions->index().instances() : scene.instances.size();
  Json j;
  j["kind"] = "scene";
  j["models"] = scene.models.size();
  j["instances"] = instances;
  std::map<elements::Class, size_t> classes;
  for (size_t k = 0; !regions && k < info.labels.size(); ++k) ++classes[info.labels[k]];
  std::string table = table_of_classes(classes, j, info);
  j["movers"] = info.movers.size();
  j["ground_triangles"] = ground;
  j["surface_triangles"] = triangles;
  j["ellipsoids"] = ellipsoids;
  if (regions) table += text_of_regions(path, *regions, j);
  j["provenance"] = io::json_of_text(info.provenance.empty() ? "null" : info.provenance);
  verb.report(j, fmt::format("{}: scene of {} instances of {} models: {} ground triangles, {} "
                             "surface triangles, {} ellipsoids\n",
                             path, instances, scene.models.size(), ground, triangles, ellipsoids) +
                     table);
}

void report_world(const Verb& verb, const std::string& path) {
  const worlds::World world = worlds::read_world(path);
  const report::WorldSummary summary{world.report, world.info};
  Json j = json_of(summary);
  j["kind"] = "world";
  verb.report(j, path + ": world in a third-party format\n" + text_of(summary));
}

void report_primitives(const Verb& verb, const std::string& path) {
  const primitives::PrimitiveSet set = primitives::read_primitive_set(path);
  std::map<elements::Class, size_t> classes;
  size_t elements = 0, points = 0;
  for (const primitives::PrimitiveEntry& e : set.entries) {
    ++classes[e.label];
    elements += e.elements;
    points += e.points;
  }
  Json j{{"kind", "primitives"}, {"primitives", set.entries.size()}};
  j["elements"] = elements;
  j["points"] = points;
  j["cell_m"] = set.cell_m;
  const std::string table = table_of_classes(classes, j);
  j["provenance"] = io::json_of_text(set.provenance);
  verb.report(j, fmt::format("{}: {} primitives of {} elements, cut from {} points\n{}"
                             "  pictures    {}/index.html\n",
                             path, set.entries.size(), elements, points, table,
                             std::filesystem::path(path).lexically_normal().string()));
}

void report_annotation(const Verb& verb, const std::string& path) {
  const primitives::Annotation annotation = primitives::read_annotation(path, true);
  std::map<elements::Class, size_t> classes;
  size_t moving = 0;
  for (const primitives::PlacedObject& o : annotation.objects) {
    ++classes[o.label];
    moving += !o.trajectory.empty();
  }
  Json j{{"kind", "annotation"}, {"objects", annotation.objects.size()}};
  j["moving"] = moving;
  j["ground"] = annotation.ground.string();
  const std::string table = table_of_classes(classes, j);
  if (!annotation.provenance.empty()) j["provenance"] = io::json_of_text(annotation.provenance);
  verb.report(
      j, fmt::format("{}: annotation of {} objects, {} of them moving, on the ground of {}\n{}",
                     path, annotation.objects.size(), moving, annotation.ground.string(), table));
}

/// Prints the distribution of the leaves' inclination [goodin24].
void report_leaves(const Verb& verb, const std::string& file, bool all) {
  const metrics::LeafCloud cloud = metrics::leaf_cloud(file, all);
  if (cloud.points.size() < 30) {
    throw DataError("fewer than 30 points of vegetation");
  }
  const metrics::LeafInclination l = metrics::leaf_inclination(cloud.points);
  const Json j = {{"kind", "leaves"},
                  {"told_by", cloud.by},
                  {"points", l.points},
                  {"mean_rad", l.mean_rad},
                  {"sigma_rad", l.sigma_rad},
                  {"epsilon", l.epsilon()},
                  {"gaussian_gap", l.gaussian_gap()},
                  {"realistic", l.is_realistic()},
                  {"histogram", l.count}};
  verb.report(
      j, fmt::format("{}: leaf inclination of {} points ({})\n  mean {:.3f}  sigma {:.3f}  "
                     "epsilon {:.3f}: {} the criterion of {:g}\n",
                     file, l.points, cloud.by, l.mean_rad, l.sigma_rad, l.epsilon(),
                     l.is_realistic() ? "inside" : "outside", metrics::LeafInclination::kLargest));
}

struct Arguments {
  std::string file, leaves;
};

void run(const Verb& verb, const Arguments& a) {
  const std::string& file = a.file;
  if (!a.leaves.empty()) return report_leaves(verb, file, a.leaves == "all");
  if (elements::is_model(file) || elements::is_scene(file) || regions::is_world(file)) {
    const pipeline::World world = pipeline::open_world(file);
    return (world.scene.instances.empty() ? report_model : report_scene)(verb, file, world);
  }
  if (worlds::is_world(file)) return report_world(verb, file);
  if (primitives::is_primitive_set(file)) return report_primitives(verb, file);
  if (std::filesystem::path(file).extension() == ".json") return report_annotation(verb, file);
  io::Input input = io::open_input(file);
  if (!input.beams) {
    throw DataError("scans without beams (" + input.format +
                    "): import it first, then ask for info on the result");
  }
  pipeline::LogContents contents;
  RangeUnit unit;
  Progress progress("info");
  for (BeamLog chunk; input.beams->next(chunk);) {
    contents.add(chunk);
    unit.add(chunk);
    progress(contents.beams, input.beams->size());
  }
  Json j = report::json_of_log(input, contents);
  std::string table = report::table_of_log(file, input.beams->info(), contents, j);
  if (const std::string warning = unit.warning(); !warning.empty()) {
    j["warnings"] = {warning};
    table += text_of_warnings({warning});
    std::cerr << "underbrush: warning: " << warning << "\n";
  }
  verb.report(j, table);
}

}  // namespace info_verb
}  // namespace

void add_info(Program& program) {
  using namespace info_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Logs", "info", "Describe a log, model, scene, mesh or annotation",
               "underbrush info log.ply\n"
               "  underbrush info log.ply --leaves vegetation",
               [a](const Verb& v) { run(v, *a); });
  verb->app
      .add_option("FILE", a->file,
                  "A log, the folder of a model, scene, world of regions or set of primitives, a "
                  "mesh or an annotation")
      ->required();
  verb->app
      .add_option("--leaves", a->leaves,
                  "Print the distribution of leaf inclinations instead: mean and sigma of arccos "
                  "n_z, and epsilon. vegetation = use the returns of plants 3 to 25 m away (by the "
                  "log's labels; without labels, all returns that are not ground); all = use all "
                  "points")
      ->check(CLI::IsMember({"vegetation", "all"}));
}

}  // namespace underbrush::app
