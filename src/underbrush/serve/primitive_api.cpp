#include "underbrush/serve/primitive_api.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/library/library.hpp"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {
namespace {

using elements::Class;
using elements::ClassKind;

constexpr size_t kMostBegun = 16;  // lists

primitives::PrimitiveSet set_of(const OpenedFile& file) {
  require(file.kind == FileKind::kPrimitives, "this file is no set of primitives");
  return primitives::read_primitive_set(file.path);
}

std::string_view name_of(ClassKind kind) {
  return std::find_if(std::begin(library::kKindNames), std::end(library::kKindNames),
                      [kind](const auto& named) { return named.second == kind; })
      ->first;
}

}  // namespace

std::string primitives_json(const OpenedFile& file) {
  const primitives::PrimitiveSet set = set_of(file);
  Json j{{"set", library::hash_of_set(set)}, {"most_name_bytes", library::kMostNameBytes}};
  for (size_t k = 0; k < elements::kClassNames.size(); ++k) {
    const ClassKind kind = elements::kind_of(Class(k));
    if (kind == ClassKind::kOther) continue;
    Json to = Json::array();
    for (size_t other = 0; other < elements::kClassNames.size(); ++other) {
      if (library::may_become(Class(k), Class(other))) to.push_back(elements::kClassNames[other]);
    }
    j["classes"].push_back(
        {{"name", elements::kClassNames[k]}, {"kind", name_of(kind)}, {"may_become", to}});
  }
  j["primitives"] = Json::array();
  for (const library::Found& f : library::find_primitives(set, {})) {
    const primitives::PrimitiveEntry& e = set.entries[f.entry];
    j["primitives"].push_back({{"folder", f.name},
                               {"name", f.given_name},
                               {"class", elements::name(e.label)},
                               {"height_m", f.height_m},
                               {"width_m", f.width_m},
                               {"points", e.points},
                               {"elements", e.elements},
                               {"set", f.origin.set},
                               {"site", f.origin.site},
                               {"season", f.origin.season},
                               {"sensor", f.origin.sensor},
                               {"license", f.origin.license}});
  }
  return text_of(j);
}

size_t PrimitiveEdits::add(const std::filesystem::path& path, const OpenedFile& file,
                           const Query& query) {
  const std::lock_guard lock(mutex_);
  Json list{{"format", "underbrush-primitive-edits"}, {"version", 1}};
  if (query.has("set")) list["set"] = query.text("set");
  const auto before = begun_.find(path);
  list["edits"] = before == begun_.end() ? Json::array() : Json::parse(before->second);
  if (before != begun_.end()) begun_.erase(before);
  const std::optional<Json> given = io::json_if_valid(query.text("edits"));
  require(given && given->is_array(), "edits: not a list of edits");
  for (const Json& edit : *given) list["edits"].push_back(edit);
  primitives::PrimitiveSet set = set_of(file);
  library::apply_edits(set, text_of(list), path.filename());
  const size_t count = list["edits"].size();
  if (query.has("more")) {
    require(begun_.size() < kMostBegun, "too many lists were begun and not ended");
    begun_[path] = text_of(list["edits"]);
  } else {
    io::write_atomically(path, io::text_of_json(list, 1) + "\n");
  }
  return count;
}

}  // namespace underbrush::serve
