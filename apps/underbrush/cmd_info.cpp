#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "cli/progress.hpp"
#include "leaf_cloud.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/metrics/leaf_inclination.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace info_verb {

/// The contents of a log, gathered in one pass.
struct Contents {
  size_t beams = 0, hits = 0, recorded = 0, inferred = 0;
  size_t echoes = 0;  ///< Hits, and further echoes of their beams.
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  double first_s = INFINITY, last_s = -INFINITY;
  double low_intensity = INFINITY, high_intensity = -INFINITY;
  std::set<uint32_t> scans;
  std::set<uint16_t> rings;
  std::vector<size_t> ranges;  ///< Histogram in steps of 1 cm up to 1 km, and one bin beyond.
  std::vector<std::string> extra;
};

constexpr double kRangeStep = 0.01;
constexpr size_t kRangeBins = 100000;

void add(const BeamLog& log, Contents& c) {
  c.ranges.resize(kRangeBins + 1);
  const std::vector<bool> begins = begins_beam(log);
  for (size_t i = 0; i < log.size(); ++i) {
    c.beams += begins[i];
    if (log.is_hit(i)) {
      c.hits += begins[i];
      ++c.echoes;
      const Vec3 end = log.end_point(i);
      c.low = c.low.cwiseMin(end);
      c.high = c.high.cwiseMax(end);
      ++c.ranges[std::min(kRangeBins, size_t(log.range_m[i] / kRangeStep))];
      c.low_intensity = std::min(c.low_intensity, double(log.intensity[i]));
      c.high_intensity = std::max(c.high_intensity, double(log.intensity[i]));
    } else {
      ++(log.flags[i] & kInferred ? c.inferred : c.recorded);
    }
    c.first_s = std::min(c.first_s, log.time_s[i]);
    c.last_s = std::max(c.last_s, log.time_s[i]);
    if (i == 0 || log.scan[i] != log.scan[i - 1]) c.scans.insert(log.scan[i]);
    if (i == 0 || log.ring[i] != log.ring[i - 1]) c.rings.insert(log.ring[i]);
  }
  c.extra.clear();
  for (const auto& [name, column] : log.extra) c.extra.push_back(name);
}

double range_percentile(const Contents& c, double share) {
  size_t sum = 0;
  for (size_t b = 0; b < c.ranges.size(); ++b) {
    sum += c.ranges[b];
    if (double(sum) >= share * double(c.echoes)) return (double(b) + 0.5) * kRangeStep;
  }
  return 0;
}

// Returns the sensors of the catalogue with as many channels as the log has rings.
std::vector<std::string> sensor_guess(const LogInfo& info, size_t rings) {
  if (!info.sensor.empty()) return {info.sensor};
  std::vector<std::string> names;
  for (const std::string& name : sensor::names()) {
    if (rings > 1 && sensor::load(name).channels.size() == rings) names.push_back(name);
  }
  return names;
}

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const LogInfo& info, const Contents& c, const io::Input& input) {
  Json j;
  j["kind"] = "log";
  j["format"] = input.format;
  j["beams"] = c.beams;
  j["hits"] = c.hits;
  j["echoes"] = c.echoes;
  j["misses"] = c.recorded + c.inferred;
  j["misses_recorded"] = c.recorded;
  j["misses_inferred"] = c.inferred;
  j["has_misses"] = info.has_misses;
  if (c.hits) j["bounds_m"] = {{"min", vector_json(c.low)}, {"max", vector_json(c.high)}};
  j["time_s"] = {{"first", c.first_s}, {"last", c.last_s}};
  j["scans"] = c.scans.size();
  j["rings"] = c.rings.size();
  j["poses"] = info.scans.size();
  Json& range = j["range_m"];
  for (const int percent : {1, 10, 50, 90, 99}) {
    if (c.hits) range["p" + std::to_string(percent)] = range_percentile(c, percent / 100.0);
  }
  if (c.hits) j["intensity"] = {{"min", c.low_intensity}, {"max", c.high_intensity}};
  j["min_range_m"] = info.min_range_m;
  j["max_range_m"] = info.max_range_m;
  j["sensor"] = info.sensor;
  j["sensor_guess"] = sensor_guess(info, c.rings.size());
  j["deskewed"] = info.deskewed;
  j["extra_columns"] = c.extra;
  j["skipped"] = input.skipped();
  j["provenance"] = input.provenance.empty() ? Json(nullptr) : io::json_of_text(input.provenance);
  return j;
}

std::string table_of(const std::string& file, const LogInfo& info, const Contents& c,
                     const Json& j) {
  const double length = c.last_s - c.first_s;
  std::string text =
      fmt::format("{}: {} beams, {} hits, {} misses ({} recorded, {} inferred)\n", file, c.beams,
                  c.hits, c.recorded + c.inferred, c.recorded, c.inferred);
  if (c.echoes > c.hits) text += fmt::format("  echoes     {}\n", c.echoes);
  if (c.hits) {
    text +=
        fmt::format("  bounds     x {:.2f} to {:.2f}  y {:.2f} to {:.2f}  z {:.2f} to {:.2f} m\n",
                    c.low.x(), c.high.x(), c.low.y(), c.high.y(), c.low.z(), c.high.z());
    text += fmt::format(
        "  ranges     1 % {:.2f}  10 % {:.2f}  50 % {:.2f}  90 % {:.2f}  99 % {:.2f} m\n",
        range_percentile(c, 0.01), range_percentile(c, 0.1), range_percentile(c, 0.5),
        range_percentile(c, 0.9), range_percentile(c, 0.99));
    text += fmt::format("  intensity  {:g} to {:g}\n", c.low_intensity, c.high_intensity);
  }
  text += fmt::format("  time       {:.3f} to {:.3f} s ({:.3f} s)\n", c.first_s, c.last_s, length);
  text += fmt::format("  scans      {}, {} with a pose, {} rings, {}\n", c.scans.size(),
                      info.scans.size(), c.rings.size(),
                      info.deskewed ? "every beam at its own origin (de-skewed)"
                                    : "one origin a scan (not de-skewed)");
  text += fmt::format("  limits     {:g} to {:g} m{}\n", info.min_range_m, info.max_range_m,
                      info.has_misses ? "" : "; no misses in this log");
  std::string sensors;
  for (const auto& name : j["sensor_guess"]) {
    sensors += (sensors.empty() ? "" : ", ") + name.get<std::string>();
  }
  text += fmt::format("  sensor     {}{}\n", sensors.empty() ? "unknown" : sensors,
                      info.sensor.empty() && !sensors.empty() ? " (guess by rings)" : "");
  if (!c.extra.empty()) text += fmt::format("  columns    {}\n", fmt::join(c.extra, ", "));
  for (const auto& [reason, n] : j["skipped"].items()) {
    text += fmt::format("  skipped    {} ({})\n", n.get<size_t>(), reason);
  }
  if (j["provenance"].is_object() && j["provenance"].contains("command")) {
    std::string words;
    for (const auto& word : j["provenance"]["command"]) words += " " + word.get<std::string>();
    text += "  made by   " + words + "\n";
  }
  return text;
}

void report_model(const Verb& verb, const std::string& path) {
  const elements::Model model = elements::read_model(path);
  Json j;
  j["kind"] = "model";
  j["fitter"] = model.fitter;
  j["ground_triangles"] = model.ground.size();
  j["surface_triangles"] = model.surface.size();
  j["ellipsoids"] = model.ellipsoids.size();
  j["tau"] = model.tau;
  j["origin_m"] = vector_json(model.origin);
  j["ground_sigma_m"] = model.ground.range_sigma_m;
  j["provenance"] = model.provenance.empty() ? Json(nullptr) : io::json_of_text(model.provenance);
  verb.report(j, fmt::format("{}: model by {}: {} ground triangles, {} surface triangles, {} "
                             "ellipsoids\n  tau {:g}, ground sigma {:.3f} m, origin {:.1f} {:.1f} "
                             "{:.1f} m\n",
                             path, model.fitter, model.ground.size(), model.surface.size(),
                             model.ellipsoids.size(), model.tau, model.ground.range_sigma_m,
                             model.origin.x(), model.origin.y(), model.origin.z()));
}

// Returns a table of the objects of each class, and puts it into `j`.
std::string table_of_classes(const std::map<elements::Class, size_t>& classes, Json& j) {
  std::string text;
  for (const auto& [c, n] : classes) {
    j["classes"][std::string(name(c))] = n;
    text += fmt::format("  {:<19}{:>8}\n", name(c), n);
  }
  return text;
}

void report_scene(const Verb& verb, const std::string& path) {
  elements::SceneInfo info;
  const elements::Scene scene = elements::read_scene(path, &info);
  size_t triangles = 0, ellipsoids = 0;
  for (const elements::Model& m : scene.models) {
    triangles += m.surface.size();
    ellipsoids += m.ellipsoids.size();
  }
  std::map<elements::Class, size_t> classes;
  for (const elements::Class c : info.labels) ++classes[c];
  Json j;
  j["kind"] = "scene";
  j["models"] = scene.models.size();
  j["instances"] = scene.instances.size();
  const std::string table = table_of_classes(classes, j);
  j["movers"] = info.movers.size();
  j["ground_triangles"] = scene.models.at(0).ground.size();
  j["surface_triangles"] = triangles;
  j["ellipsoids"] = ellipsoids;
  j["provenance"] = io::json_of_text(info.provenance.empty() ? "null" : info.provenance);
  std::string text = fmt::format(
      "{}: scene of {} instances of {} models: {} ground triangles, {} surface triangles, {} "
      "ellipsoids\n",
      path, scene.instances.size(), scene.models.size(), scene.models.at(0).ground.size(),
      triangles, ellipsoids);
  verb.report(j, text + table);
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
  const LeafCloud cloud = leaf_cloud(file, all);
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
  if (elements::is_model(file)) return report_model(verb, file);
  if (elements::is_scene(file)) return report_scene(verb, file);
  if (primitives::is_primitive_set(file)) return report_primitives(verb, file);
  if (std::filesystem::path(file).extension() == ".json") return report_annotation(verb, file);
  io::Input input = io::open_input(file);
  if (!input.beams) {
    throw DataError("scans without beams (" + input.format +
                    "): import it first, then ask for info on the result");
  }
  Contents contents;
  Progress progress("info");
  for (BeamLog chunk; input.beams->next(chunk);) {
    add(chunk, contents);
    progress(contents.beams, input.beams->size());
  }
  const Json j = json_of(input.beams->info(), contents, input);
  verb.report(j, table_of(file, input.beams->info(), contents, j));
}

}  // namespace info_verb
}  // namespace

void add_info(Program& program) {
  using namespace info_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(program, "Logs", "info",
                             "Describe a log, model, scene, set of primitives or annotation",
                             "underbrush info log.ply\n"
                             "  underbrush info log.ply --leaves vegetation",
                             [a](const Verb& v) { run(v, *a); });
  verb->app
      .add_option("FILE", a->file,
                  "A log, the folder of a model, scene or set of primitives, or an annotation")
      ->required();
  verb->app
      .add_option("--leaves", a->leaves,
                  "Print the inclination of the leaves instead (mean and sigma of arccos n_z, and "
                  "epsilon): of a log's vegetation, which is what its labels say or else what is "
                  "not ground, 3 to 25 m away; or of all points")
      ->check(CLI::IsMember({"vegetation", "all"}));
}

}  // namespace underbrush::app
