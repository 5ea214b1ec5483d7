#include <map>
#include <nlohmann/json.hpp>

#include "underbrush/io/json_text.inl"
#include "underbrush/pipeline/reports_json.inl"

namespace underbrush::pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// The number of primitives of a class, and of their elements.
struct ClassCount {
  size_t primitives = 0, elements = 0;
};

std::map<elements::Class, ClassCount> classes_of(const std::vector<primitives::Primitive>& all) {
  std::map<elements::Class, ClassCount> out;
  for (const primitives::Primitive& p : all) {
    ++out[p.label].primitives;
    out[p.label].elements += p.model.size();
  }
  return out;
}

/// Counts the elements except those of the ground.
size_t elements_of(const elements::Scene& scene) {
  size_t elements = 0;
  for (const elements::Model& m : scene.models) elements += m.size() - m.ground.size();
  return elements;
}

}  // namespace

Json json_of(const regions::GeneratedSite& site) {
  Json j{{"objects", 0}, {"parts", site.parts}, {"triangles", site.triangles}};
  size_t objects = 0;
  for (const auto& [label, n] : site.objects) {
    j["classes"][std::string(name(label))] = n;
    objects += n;
  }
  j["objects"] = objects;
  return j;
}

Json json_of(const primitives::MeasuredObjects& measured) {
  Json j;
  j["objects"] = measured.objects.size();
  std::map<elements::Class, size_t> classes;
  for (const auto& o : measured.objects) ++classes[o.label];
  for (const auto& [label, n] : classes) j["classes"][std::string(name(label))] = n;
  j["few_points"] = measured.few_points;
  j["off_ground"] = measured.off_ground;
  j["hits_without_instance"] = measured.without_instance;
  return j;
}

Json json_of(const AnnotatedSite& site) {
  Json j = json_of(site.measured);
  if (!site.drawn) return j;
  j["replaced"] = site.drawn->replaced;
  j["left_out"] = site.drawn->left_out;
  j["objects_off_ground"] = site.drawn->off_ground;
  j["missing_cells"] = site.drawn->missing_cells;
  for (const sites::ComparedStatistic& s : site.statistics) {
    j["statistics"].push_back({{"name", s.site.name},
                               {"unit", s.site.unit},
                               {"site", io::finite_or_null(s.site.value)},
                               {"mean", io::finite_or_null(s.mean)},
                               {"low", io::finite_or_null(s.low)},
                               {"high", io::finite_or_null(s.high)}});
  }
  return j;
}

Json json_of(const primitives::ExtractResult& r) {
  Json j;
  j["primitives"] = r.primitives.size();
  j["elements"] = r.elements;
  j["elements_taken"] = r.taken;
  j["free_space"] = r.free_space;
  j["empty"] = r.empty;
  j["few_elements"] = r.few_elements;
  j["few_points"] = r.measured.few_points;
  j["off_ground"] = r.measured.off_ground;
  j["hits_without_instance"] = r.measured.without_instance;
  for (const auto& [label, n] : classes_of(r.primitives)) {
    j["classes"][std::string(name(label))] = {{"primitives", n.primitives},
                                              {"elements", n.elements}};
  }
  return j;
}

Json json_of(const MeshSet& set, const MeshesOptions& options) {
  Json j{{"plants", set.plants}, {"primitives", set.primitives.size()}, {"triangles", 0}};
  size_t triangles = 0;
  for (const auto& [label, n] : classes_of(set.primitives)) {
    j["classes"][std::string(name(label))] = {{"primitives", n.primitives},
                                              {"triangles", n.elements}};
    triangles += n.elements;
  }
  j["triangles"] = triangles;
  j["scale"] = {set.least_scale, set.most_scale};
  j["range_noise_m"] = options.meshes.range_sigma_m;
  return j;
}

Json json_of(const ComposedScene& scene, const ComposeOptions& options) {
  const primitives::Composition& c = scene.composition;
  Json j;
  j["objects"] = c.objects;
  j["instances"] = c.placed;
  j["models"] = c.scene.models.size() - 1;
  j["elements"] = elements_of(c.scene);
  j["off_ground"] = c.off_ground;
  j["left_out"] = c.left_out;
  j["borrowed"] = c.borrowed;
  j["mean_box_distance_m"] = c.mean_box_distance_m;
  if (!options.leave_out.empty()) j["primitives_left_out"] = scene.primitives_left_out;
  j["warnings"] = scene.warnings;
  j["seconds"] = scene.seconds;
  return j;
}

}  // namespace underbrush::pipeline
