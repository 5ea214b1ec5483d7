#include "underbrush/library/edits.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/json_file.hpp"

namespace underbrush::library {
namespace {

using elements::Class;
using elements::ClassKind;
using primitives::PrimitiveEntry;
using primitives::PrimitiveSet;

bool is_of_patches(Class c) { return elements::kind_of(c) == ClassKind::kPatch; }

Class class_in(const io::JsonValue& j, Class before) {
  const std::string text = j.text("a name");
  const auto label = elements::class_from_name(text);
  if (!label || elements::kind_of(*label) == ClassKind::kOther) {
    std::vector<std::string> known;
    for (const std::string_view name : elements::kClassNames) {
      if (may_become(before, *elements::class_from_name(name))) known.emplace_back(name);
    }
    const std::string near = nearest_name(text, known);
    j.fail("no class of primitives " + in_quotes(text) +
           (near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
  if (!may_become(before, *label)) {
    const bool is_cell = is_of_patches(before);
    j.fail(in_quotes(text) + " is a class of " + (is_cell ? "plants" : "cells of patches") +
           ", and the primitive is a " + (is_cell ? "cell of a patch" : "plant"));
  }
  return *label;
}

std::string name_in(const io::JsonValue& j) {
  std::string text = j.text();
  if (text.size() > kMostNameBytes) {
    j.fail("longer than " + std::to_string(kMostNameBytes) + " bytes");
  }
  if (printable(text) != text) j.fail("has a character that cannot be shown");
  return text;
}

/// Changes an entry; returns whether it stays.
bool apply(const io::JsonValue& edit, PrimitiveEntry& entry, EditCounts& counts) {
  edit.check_members({"primitive", "remove", "class", "name", "comment"});
  const auto remove = edit.find("remove"), label = edit.find("class"), name = edit.find("name");
  if (!remove && !label && !name) edit.fail("needs 'remove', 'class' or 'name'");
  if (remove) {
    if (!remove->boolean()) remove->fail("must be true");
    if (label || name) edit.fail("a primitive that is thrown out has no class or name");
    ++counts.thrown_out;
    return false;
  }
  if (label) {
    const Class to = class_in(*label, entry.label);
    counts.relabelled += size_t(to != entry.label);
    entry.label = to;
  }
  if (name) {
    entry.given_name = name_in(*name);
    ++counts.named;
  }
  return true;
}

EditCounts apply_all(PrimitiveSet& set, const io::JsonFile& file) {
  const io::JsonValue j =
      file.manifest("underbrush-primitive-edits", 1, "a list of edits of primitives");
  j.check_members({"$schema", "format", "version", "comment", "set", "edits"});
  if (const auto hash = j.find("set"); hash && hash->text() != hash_of_set(set)) {
    hash->fail("the edits were made for another set, or for this one before it changed");
  }
  std::map<std::string_view, PrimitiveEntry*> entries;
  for (PrimitiveEntry& e : set.entries) entries.emplace(e.name, &e);
  std::map<const PrimitiveEntry*, bool> stays;
  EditCounts counts;
  const io::JsonValue list = j.at("edits");
  for (const io::JsonValue& edit : list.values()) {
    const io::JsonValue primitive = edit.at("primitive");
    const std::string name = primitive.text();
    const auto found = entries.find(name);
    if (found == entries.end()) primitive.fail("there is no such primitive: " + in_quotes(name));
    if (stays.contains(found->second)) primitive.fail("an edit before names it, too");
    stays[found->second] = apply(edit, *found->second, counts);
  }
  if (counts.thrown_out > 0 && counts.thrown_out == set.entries.size()) {
    list.fail("all primitives are thrown out");
  }
  std::vector<PrimitiveEntry> kept;
  for (PrimitiveEntry& e : set.entries) {
    const auto edited = stays.find(&e);
    if (edited == stays.end() || edited->second) kept.push_back(std::move(e));
  }
  set.entries = std::move(kept);
  return counts;
}

}  // namespace

bool may_become(Class from, Class to) {
  return elements::kind_of(to) != ClassKind::kOther && is_of_patches(from) == is_of_patches(to);
}

EditCounts apply_edits(PrimitiveSet& set, const std::filesystem::path& list) {
  return apply_all(set, io::JsonFile(list));
}

EditCounts apply_edits(PrimitiveSet& set, const std::string& list,
                       const std::filesystem::path& path) {
  return apply_all(set, io::JsonFile(path, list));
}

std::string hash_of_set(const PrimitiveSet& set) {
  return io::hash_of(set.folder / "primitives.json");
}

}  // namespace underbrush::library
