#include "underbrush/primitives/annotation.hpp"

#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/primitives/object_json.inl"

namespace underbrush::primitives {
namespace fs = std::filesystem;
namespace {

constexpr const char* kAdvice = "; --allow-outside follows it";

PlacedObject object_of(const io::JsonValue& j, bool outside) {
  j.check_members({"class", "position_m", "yaw_rad", "box_m", "instance", "points", "layers_m",
                   "quantiles_m", "beams", "trajectory", "comment"});
  PlacedObject o = object_of_json(j);
  if (const auto poses = j.find("trajectory")) o.trajectory = poses->path(outside, kAdvice);
  return o;
}

}  // namespace

void write_annotation(const fs::path& path, const Annotation& a) {
  Json j;
  j["format"] = "underbrush-annotation";
  j["version"] = kAnnotationVersion;
  const fs::path folder = fs::absolute(path).parent_path();
  j["ground"] =
      fs::absolute(a.ground).lexically_normal().lexically_relative(folder).generic_string();
  j["provenance"] = a.provenance.empty() ? Json::object() : io::json_of_text(a.provenance);
  // Each object is a line, so that the file can be read, compared and edited.
  std::string text = io::text_of_json(j, 1);
  text.erase(text.find_last_of('}') - 1);
  text += ",\n \"objects\": [";
  for (size_t k = 0; k < a.objects.size(); ++k) {
    Json object = json_of_object(a.objects[k]);
    if (const fs::path& poses = a.objects[k].trajectory; !poses.empty()) {
      object["trajectory"] =
          fs::absolute(poses).lexically_normal().lexically_relative(folder).generic_string();
    }
    text += (k ? ",\n  " : "\n  ") + io::text_of_json(object);
  }
  text += a.objects.empty() ? "]\n}\n" : "\n ]\n}\n";
  io::write_atomically(path, text);
}

void write_annotation(const fs::path& path, const Annotation& annotation, elements::Model ground) {
  ground.provenance = annotation.provenance;
  io::AtomicFile folder(annotation.ground, io::OutputKind::kFolder);
  elements::write_model(folder.temporary(), ground);
  write_annotation(path, annotation);
  folder.commit();
}

Annotation read_annotation(const fs::path& path, bool outside) {
  const io::JsonFile json(path);
  json.root().check_members(
      {"format", "version", "ground", "objects", "provenance", "comment", "$schema"});
  const io::JsonValue j =
      json.manifest("underbrush-annotation", kAnnotationVersion, "an underbrush annotation");
  Annotation a;
  a.ground = j.at("ground").path(outside, kAdvice);
  for (const io::JsonValue& object : j.at("objects").values()) {
    a.objects.push_back(object_of(object, outside));
  }
  if (const auto provenance = j.find("provenance")) a.provenance = provenance->dump();
  return a;
}

}  // namespace underbrush::primitives
