#include "underbrush/serve/actor_api.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "underbrush/actors/actor_edits.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {
namespace {

constexpr const char* kEdits = "edits";

// The content of a file of edits, none of which names another file: `text` itself, or with `text`
// as its edits. Errors name it `place`.
Json list_of(const std::string& text, const std::string& place) {
  const auto check = [&](bool ok, const std::string& what) {
    if (!ok) throw std::invalid_argument(place.empty() ? what : place + ": " + what);
  };
  std::optional<Json> given = text.empty() ? Json::array() : io::json_if_valid(text);
  if (given && given->is_array()) {
    given = {
        {"format", "underbrush-actor-edits"}, {"version", 1}, {"actors", "."}, {"edits", *given}};
  }
  check(given && given->is_object() && given->contains("format"), "not a list of edits of actors");
  size_t number = 0;
  for (const Json& edit : given->value("edits", Json::array())) {
    check(!edit.is_object() || !(edit.contains("trajectory") || edit.contains("model")),
          "edits[" + std::to_string(number++) + "] names a file, which edits on the page do not");
  }
  return *std::move(given);
}

// What moves in a scene, without the models.
std::vector<actors::Actor> moving(const WorldData& world) {
  const elements::SceneInfo& info = world.info();
  std::vector<actors::Actor> out;
  for (const elements::Mover& m : info.movers) {
    const uint32_t model = world.scene().instances[m.instance].model;
    const std::string label = elements::class_name(info, info.labels[m.instance]);
    out.push_back(
        {info.names[model], label, {}, m.world_from_object, m.from_s, m.to_s, m.instance});
  }
  return out;
}

std::vector<actors::Actor> edited(const WorldData& world, const Json& list,
                                  const std::string& place) {
  std::vector<actors::Actor> out = moving(world);
  actors::apply_edits(out, text_of(list), place);
  return out;
}

bool all_moves(const WorldData& world) {
  return world.info().movers.size() == world.scene().instances.size();
}

Json json_of(const actors::Actor& part, const Vec3& origin) {
  Json j{{"instance", part.instance},
         {"from_s", io::finite_or_null(part.from_s)},
         {"to_s", io::finite_or_null(part.to_s)},
         {"poses", Json::array()}};
  for (const StampedPose& p : part.world_from_actor.poses()) {
    const Vec3 at = p.world_from_sensor.translation - origin;
    const Eigen::Quaterniond& q = p.world_from_sensor.rotation;
    j["poses"].push_back({p.time_s, at.x(), at.y(), at.z(), q.w(), q.x(), q.y(), q.z()});
  }
  return j;
}

// What the provenance of the scene says of the thing that an actor is, or is a copy of.
Json learnt(const Json& provenance, const std::string& name) {
  const auto found = provenance.find("actors");
  if (found == provenance.end() || !found->is_array()) return nullptr;
  for (const Json& entry : *found) {
    if (entry.is_object() && entry.value("name", Json()) == name) return entry;
  }
  return nullptr;
}

}  // namespace

std::string actors_json(const WorldData& world, const std::string& edits,
                        const std::string& place) {
  const Json given = list_of(edits, place);
  const std::vector<actors::Actor> list = edited(world, given, place);
  const elements::SceneInfo& info = world.info();
  const Json provenance = io::json_if_valid(info.provenance).value_or(Json::object());
  Json j{{"editable", all_moves(world)}, {"list", given}, {"actors", Json::array()}};
  for (const std::string& name : actors::names_of(list)) {
    Json actor{{"name", printable(name)}};
    for (const actors::Actor& a : list) {
      if (a.name != name) continue;
      if (!actor.contains("parts")) {
        const uint32_t model = world.scene().instances[a.instance].model;
        const Json facts = learnt(provenance, info.names[model]);
        actor["class"] = a.label;
        for (const char* key : {"returns", "scans"}) {
          actor[key] = facts.is_object() ? facts.value(key, Json()) : Json();
        }
        actor["parts"] = Json::array();
      }
      actor["parts"].push_back(json_of(a, world.origin()));
    }
    j["actors"].push_back(std::move(actor));
  }
  return text_of(j);
}

void write_edits(const std::filesystem::path& path, const OpenedFile& scene, const WorldData& world,
                 const std::string& edits) {
  require(scene.kind == FileKind::kScene && all_moves(world),
          "only a folder of actors, in which all moves, can be edited");
  Json list = list_of(edits, kEdits);
  edited(world, list, kEdits);
  list["actors"] = scene.path.lexically_relative(path.parent_path()).string();
  io::write_atomically(path, io::text_of_json(list, 1) + "\n");
}

GivenEdits read_edits(const std::filesystem::path& file) try {
  actors::read_actors(file);
  const Json list = list_of(read_file(file), "");
  const std::string folder = list.at("actors");
  return {std::filesystem::canonical(file.parent_path() / folder), text_of(list)};
} catch (const std::invalid_argument& e) {
  throw FormatError(file.string(), "", e.what());
}

}  // namespace underbrush::serve
