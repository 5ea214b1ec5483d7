#include "underbrush/perception/object_list_file.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/perception/object_columns.hpp"
#include "underbrush/perception/object_csv.hpp"

namespace underbrush::perception {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "underbrush-object-lists";
constexpr uint64_t kVersion = 1;

Json json_of(TrackedObject o) {
  Json j;
  j["id"] = o.id;
  if (o.truth_id) j["truth_id"] = o.truth_id;
  j["class"] = name(o.label);
  j["measured"] = o.is_measured;
  j["points"] = o.points;
  for (const ObjectColumn& c : object_columns()) j[c.name] = c.value(o);
  for (size_t c = 1; c < kClassCount; ++c) {
    if (o.probability[c] > 0)
      j["probability"][std::string(name(ObjectClass(c)))] = o.probability[c];
  }
  return j;
}

Json json_of(const ObjectList& list) {
  Json j;
  j["time"] = list.time_s;
  j["available"] = list.available_s;
  const auto pose = pose_values(list.world_from_vehicle);
  for (size_t k = 0; k < pose.size(); ++k) j[kPoseColumns[k]] = pose[k];
  j["objects"] = Json::array();
  return j;
}

TrackedObject object_of(const io::JsonValue& j) {
  TrackedObject o;
  o.id = j.at("id").count();
  if (const auto id = j.find("truth_id")) o.truth_id = id->count();
  if (const auto label = j.find("class")) {
    const auto known = class_of_name(label->text());
    if (!known) label->fail("unknown class");
    o.label = *known;
  }
  if (const auto m = j.find("measured")) o.is_measured = m->boolean();
  if (const auto n = j.find("points")) o.points = uint32_t(n->count(UINT32_MAX));
  for (const ObjectColumn& c : object_columns()) {
    const auto value = is_of_box(c.name) ? j.at(c.name) : j.find(c.name);
    if (value) c.value(o) = value->number();
  }
  if (const auto p = j.find("probability")) {
    for (const std::string& word : p->member_names()) {
      const auto label = class_of_name(word);
      if (!label) p->fail("unknown class");
      o.probability[size_t(*label)] = float(p->at(word.c_str()).number());
    }
  }
  return o;
}

ObjectList list_of(const io::JsonValue& j) {
  ObjectList list;
  list.time_s = list.available_s = j.at("time").number();
  if (const auto t = j.find("available")) list.available_s = t->number();
  if (j.find(kPoseColumns[0])) {
    std::array<double, 7> v{};
    for (size_t k = 0; k < v.size(); ++k) v[k] = j.at(kPoseColumns[k]).number();
    const auto pose = pose_of_values(v);
    if (!pose) j.at(kPoseColumns[6]).fail("the quaternion's length is not 1");
    list.world_from_vehicle = *pose;
  }
  for (const io::JsonValue& object : j.at("objects").values()) {
    list.objects.push_back(object_of(object));
  }
  return list;
}

std::vector<ObjectList> read_json(const fs::path& path) {
  const io::JsonFile file(path);
  const io::JsonValue root = file.manifest(kFormat, kVersion, "a list of objects");
  std::vector<ObjectList> lists;
  for (const io::JsonValue& j : root.at("lists").values()) {
    lists.push_back(list_of(j));
    if (lists.size() > 1 && lists.back().time_s <= lists[lists.size() - 2].time_s) {
      j.at("time").fail("times must ascend");
    }
  }
  return lists;
}

// Each object is a line, so that the file can be read and compared.
std::string json_text(std::span<const ObjectList> lists, const std::string& provenance) {
  Json head;
  head["format"] = kFormat;
  head["version"] = kVersion;
  head["provenance"] = provenance.empty() ? Json::object() : io::json_of_text(provenance);
  std::string text = io::text_of_json(head);
  text.pop_back();
  text += ",\n\"lists\": [";
  for (size_t k = 0; k < lists.size(); ++k) {
    std::string list = io::text_of_json(json_of(lists[k]));
    list.resize(list.size() - 2);  // Without "]}".
    text += (k ? ",\n " : "\n ") + list;
    for (size_t i = 0; i < lists[k].objects.size(); ++i) {
      text += (i ? ",\n  " : "\n  ") + io::text_of_json(json_of(lists[k].objects[i]));
    }
    text += "]}";
  }
  return text + "\n]}\n";
}

}  // namespace

void write_object_lists(const fs::path& path, std::span<const ObjectList> lists,
                        const std::string& provenance) {
  const std::string extension = path.extension().string();
  io::write_atomically(path, extension == ".json" ? json_text(lists, provenance) : csv_of(lists));
}

std::vector<ObjectList> read_object_lists(const fs::path& path) {
  return path.extension() == ".json" ? read_json(path) : read_object_csv(path);
}

bool is_object_list_file(const fs::path& path) {
  const std::string extension = path.extension().string();
  if ((extension != ".csv" && extension != ".json") || !is_file(path)) return false;
  std::ifstream in(path, std::ios::binary);
  std::string start(4096, '\0');
  in.read(start.data(), std::streamsize(start.size()));
  start.resize(size_t(std::max<std::streamsize>(in.gcount(), 0)));
  return start.find(extension == ".json" ? kFormat : "vehicle_qw") != std::string::npos;
}

}  // namespace underbrush::perception
