#include "underbrush/actors/actor_edits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/poses.hpp"

namespace underbrush::actors {
namespace fs = std::filesystem;
namespace {

bool is_named(const std::vector<Actor>& actors, const std::string& name) {
  return std::ranges::find(actors, name, &Actor::name) != actors.end();
}

void check_named(const std::vector<Actor>& actors, const std::string& name) {
  if (!is_named(actors, name))
    throw std::invalid_argument("there is no such actor: " + in_quotes(name));
}

/// Changes each actor of a name.
template <class Change>
void change(std::vector<Actor>& actors, const std::string& name, Change&& change_one) {
  check_named(actors, name);
  for (Actor& a : actors) {
    if (a.name == name) change_one(a);
  }
}

template <class Change>
Trajectory changed(const Trajectory& path, Change&& change_one) {
  std::vector<StampedPose> poses = path.poses();
  for (StampedPose& p : poses) change_one(p);
  return Trajectory(std::move(poses));
}

double number_or(const io::JsonValue& edit, const char* member, double otherwise) {
  const auto value = edit.find(member);
  return value ? value->number() : otherwise;
}

void move(const io::JsonValue& edit, std::vector<Actor>& actors, const std::string& name) {
  Pose by{Eigen::Quaterniond(Eigen::AngleAxisd(number_or(edit, "yaw_rad", 0), Vec3::UnitZ())),
          Vec3::Zero()};
  if (const auto to = edit.find("translation_m")) by.translation = to->vector();
  move_actor(actors, name, by);
}

void delay(const io::JsonValue& edit, std::vector<Actor>& actors, const std::string& name) {
  delay_actor(actors, name, edit.at("by_s").number());
}

void shift(const io::JsonValue& edit, std::vector<Actor>& actors, const std::string& name) {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  const auto within = edit.find("within_s");
  if (edit.find("at_s").has_value() != within.has_value())
    edit.fail("at_s and within_s need each other");
  if (within && !(within->number() > 0)) within->fail("must be above 0");
  shift_actor(actors, name, edit.at("translation_m").vector(), number_or(edit, "at_s", 0),
              number_or(edit, "within_s", kAll));
}

void copy(const io::JsonValue& edit, std::vector<Actor>& actors, const std::string& name) {
  copy_actor(actors, name, edit.at("as").text());
}

void redirect(const io::JsonValue& edit, std::vector<Actor>& actors, const std::string& name) {
  redirect_actor(actors, name, io::read_trajectory(edit.at("trajectory").path(true)));
}

void replace(const io::JsonValue& edit, std::vector<Actor>& actors, const std::string& name) {
  replace_model(actors, name, at_zero(read_mover(edit.at("model").path(true))));
}

void remove(const io::JsonValue&, std::vector<Actor>& actors, const std::string& name) {
  remove_actor(actors, name);
}

/// The kinds of edits, with the members that each has besides "edit" and "actor".
struct Kind {
  std::string_view name;
  std::vector<const char*> members;
  void (*apply)(const io::JsonValue&, std::vector<Actor>&, const std::string&);
};
const Kind kKinds[] = {
    {"remove", {}, remove},        {"move", {"translation_m", "yaw_rad"}, move},
    {"delay", {"by_s"}, delay},    {"shift", {"translation_m", "at_s", "within_s"}, shift},
    {"copy", {"as"}, copy},        {"trajectory", {"trajectory"}, redirect},
    {"model", {"model"}, replace},
};

void apply(const io::JsonValue& edit, std::vector<Actor>& actors) {
  const std::string name = edit.at("edit").text();
  const auto* kind = std::ranges::find(kKinds, name, &Kind::name);
  if (kind == std::end(kKinds)) {
    edit.at("edit").fail("must be remove, move, shift, delay, copy, trajectory or model");
  }
  for (const std::string& member : edit.member_names()) {
    const bool is_common = member == "edit" || member == "actor" || member == "comment";
    if (!is_common && std::ranges::find(kind->members, member) == kind->members.end()) {
      edit.fail("unknown member " + in_quotes(member));
    }
  }
  const io::JsonValue actor = edit.at("actor");
  try {
    kind->apply(edit, actors, actor.text());
  } catch (const std::invalid_argument& e) {
    actor.fail(e.what());
  } catch (const FormatError& e) {
    if (e.file() == edit.file().string()) throw;
    edit.fail(e.what());  // Of a file that the edit names.
  }
}

io::JsonValue list_in(const io::JsonFile& json) {
  io::JsonValue j = json.manifest("underbrush-actor-edits", 1, "a list of edits of actors");
  j.check_members({"$schema", "format", "version", "comment", "actors", "edits"});
  return j;
}

}  // namespace

void remove_actor(std::vector<Actor>& actors, const std::string& name) {
  check_named(actors, name);
  std::erase_if(actors, [&](const Actor& a) { return a.name == name; });
}

void move_actor(std::vector<Actor>& actors, const std::string& name, const Pose& actor_from_moved) {
  change(actors, name, [&](Actor& a) {
    a.world_from_actor = changed(a.world_from_actor, [&](StampedPose& p) {
      p.world_from_sensor = p.world_from_sensor * actor_from_moved;
    });
  });
}

void shift_actor(std::vector<Actor>& actors, const std::string& name, const Vec3& by, double at_s,
                 double within_s) {
  change(actors, name, [&](Actor& a) {
    a.world_from_actor = changed(a.world_from_actor, [&](StampedPose& p) {
      const double off = std::isinf(within_s) ? 0 : std::abs(p.time_s - at_s) / within_s;
      if (off < 1) p.world_from_sensor.translation += (1 + std::cos(M_PI * off)) / 2 * by;
    });
  });
}

void delay_actor(std::vector<Actor>& actors, const std::string& name, double by_s) {
  change(actors, name, [&](Actor& a) {
    a.world_from_actor = changed(a.world_from_actor, [&](StampedPose& p) { p.time_s += by_s; });
    a.from_s += by_s;
    a.to_s += by_s;
  });
}

void copy_actor(std::vector<Actor>& actors, const std::string& name, const std::string& as) {
  require(!is_named(actors, as), "the copy's name is that of another actor");
  std::vector<Actor> copies;
  change(actors, name, [&](const Actor& a) { copies.push_back(a); });
  for (Actor& a : copies) {
    a.name = as;
    actors.push_back(std::move(a));
  }
}

void redirect_actor(std::vector<Actor>& actors, const std::string& name,
                    const Trajectory& world_from_actor) {
  require(!world_from_actor.empty(), "the trajectory has no poses");
  const bool is_single = std::ranges::count(actors, name, &Actor::name) == 1;
  change(actors, name, [&](Actor& a) {
    a.world_from_actor = world_from_actor;
    if (!is_single) return;
    a.from_s = world_from_actor.poses().front().time_s;
    a.to_s = world_from_actor.poses().back().time_s;
  });
}

void replace_model(std::vector<Actor>& actors, const std::string& name, elements::Model model) {
  Actor* first = nullptr;
  change(actors, name, [&](Actor& a) {
    if (!first) first = &a;
    first->from_s = std::min(first->from_s, a.from_s);
    first->to_s = std::max(first->to_s, a.to_s);
  });
  first->model = std::move(model);
  bool is_first = true;
  std::erase_if(actors,
                [&](const Actor& a) { return a.name == name && !std::exchange(is_first, false); });
}

void apply_edits(std::vector<Actor>& actors, const std::string& list, const fs::path& place) {
  const io::JsonFile json(place, list);
  for (const io::JsonValue& edit : list_in(json).at("edits").values()) apply(edit, actors);
}

std::vector<Actor> read_actors(const fs::path& file) {
  if (fs::is_directory(file)) return read_actor_folder(file);
  const io::JsonFile json(file);
  const io::JsonValue j = list_in(json);
  const fs::path folder = j.at("actors").path(true);
  if (!fs::is_directory(folder)) j.at("actors").fail("there is no such folder");
  std::vector<Actor> actors;
  try {
    actors = read_actor_folder(folder);
  } catch (const FormatError& e) {
    j.at("actors").fail(e.what());
  }
  for (const io::JsonValue& edit : j.at("edits").values()) apply(edit, actors);
  return actors;
}

}  // namespace underbrush::actors
