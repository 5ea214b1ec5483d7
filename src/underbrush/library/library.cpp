#include "underbrush/library/library.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"

namespace underbrush::library {
namespace {

using elements::Class;
using elements::ClassKind;
using primitives::PlacedObject;
using primitives::Primitive;
using primitives::PrimitiveOrigin;
using primitives::PrimitiveSet;

/// Whether a class is one of those of the names.
bool is_among(Class label, const std::vector<std::string>& names) {
  return names.empty() || std::any_of(names.begin(), names.end(), [&](const std::string& name) {
           return name == elements::name(label) ||
                  std::any_of(std::begin(kKindNames), std::end(kKindNames), [&](const auto& kind) {
                    return name == kind.first && elements::kind_of(label) == kind.second;
                  });
         });
}

void check_classes(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const auto& [name, kind] : kKindNames) known.emplace_back(name);
  for (const std::string_view name : elements::kClassNames) {
    if (elements::kind_of(*elements::class_from_name(name)) != ClassKind::kOther) {
      known.emplace_back(name);
    }
  }
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_name(name, known);
    throw std::invalid_argument("primitives: no class or kind " + in_quotes(name) +
                                (near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
}

/// The text of a set among those of all sets.
std::string text_of_set(const std::vector<std::string>& texts, size_t set, size_t sets,
                        const char* what) {
  if (texts.empty()) return "";
  if (texts.size() != 1 && texts.size() != sets) {
    throw std::invalid_argument("primitives: " + std::string(what) +
                                " needs one text, or one for each of " + std::to_string(sets) +
                                " sets");
  }
  return texts[texts.size() == 1 ? 0 : set];
}

bool has_equal_elements(const elements::Model& a, const elements::Model& b) {
  const auto same_ellipsoid = [](const elements::Ellipsoid& x, const elements::Ellipsoid& y) {
    return x.mean == y.mean && x.covariance == y.covariance && x.hit.p == y.hit.p;
  };
  return a.surface.vertices == b.surface.vertices && a.surface.triangles == b.surface.triangles &&
         std::equal(a.ellipsoids.begin(), a.ellipsoids.end(), b.ellipsoids.begin(),
                    b.ellipsoids.end(), same_ellipsoid);
}

/// Whether the middle of the box of `a`, seen from above, lies in the box of `b`.
bool stands_in(const PlacedObject& a, const PlacedObject& b) {
  const Vec3 middle = a.world_from_object() * Vec3(0.5 * (a.box.min + a.box.max));
  const Vec3 at = b.world_from_object().inverse() * middle;
  return at.x() >= b.box.min.x() && at.x() <= b.box.max.x() && at.y() >= b.box.min.y() &&
         at.y() <= b.box.max.y();
}

/// Merges sets one after the other.
class Merger {
 public:
  explicit Merger(const Options& options) : options_(options) {}

  void add(const PrimitiveSet& set, const PrimitiveOrigin& about) {
    const auto first = uint32_t(out_.origins.size());
    std::vector<PrimitiveOrigin> origins = set.origins;
    if (origins.empty()) origins.push_back(origin_of_set(set));
    for (PrimitiveOrigin& o : origins) {
      if (!about.site.empty()) o.site = about.site;
      if (!about.season.empty()) o.season = about.season;
      if (!about.license.empty()) o.license = about.license;
      out_.origins.push_back(o);
    }
    PrimitiveSet known = set;  // With what the options say of it.
    known.origins = origins;
    const std::vector<Found> wanted = find_primitives(known, options_);
    out_.not_wanted += set.entries.size() - wanted.size();
    for (const Found& found : wanted) {
      Primitive p = primitives::read_whole_primitive(set, found.entry);
      p.origin += first;
      add(std::move(p));
    }
  }

  Merged finish() && {
    std::stable_sort(out_.primitives.begin(), out_.primitives.end(),
                     [](const Primitive& a, const Primitive& b) { return a.label < b.label; });
    out_.without_license = size_t(std::count_if(out_.origins.begin(), out_.origins.end(),
                                                [](const auto& o) { return o.license.empty(); }));
    return std::move(out_);
  }

 private:
  static PrimitiveOrigin origin_of_set(const PrimitiveSet& set) {
    PrimitiveOrigin out;
    out.set = set.folder.lexically_normal().filename().string();
    if (out.set.empty()) out.set = set.folder.lexically_normal().parent_path().filename().string();
    if (!set.entries.empty()) out.sensor = primitives::read_primitive(set, 0).sensor;
    out.provenance = set.provenance;
    return out;
  }

  bool are_duplicates(const Primitive& a, const Primitive& b) const {
    if (a.label != b.label) return false;
    if (a.model.size() == b.model.size() && has_equal_elements(a.model, b.model)) return true;
    const std::string& site = out_.origins[a.origin].site;
    return a.origin != b.origin && !site.empty() && site == out_.origins[b.origin].site &&
           a.plants.empty() && b.plants.empty() && stands_in(a.source, b.source) &&
           stands_in(b.source, a.source);
  }

  void add(Primitive p) {
    const auto same = std::find_if(out_.primitives.begin(), out_.primitives.end(),
                                   [&](const Primitive& q) { return are_duplicates(p, q); });
    if (same != out_.primitives.end()) {
      ++out_.duplicates;
      if (!options_.keep_duplicates) {
        std::string name = same->given_name.empty() ? p.given_name : same->given_name;
        if (p.source.points > same->source.points) {
          if (!p.given_name.empty()) name = p.given_name;
          *same = std::move(p);
        }
        same->given_name = std::move(name);
        return;
      }
    }
    out_.primitives.push_back(std::move(p));
  }

  const Options& options_;
  Merged out_;
};

}  // namespace

// long: the table of the options.
std::span<const Option<Options>> options() {
  using O = Options;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"class", "Search", "",
     "List or merge only primitives of these classes, or of the kinds shrub, tree, patch",
     [](O& o) -> auto& { return o.classes; }, -kNoLimit, kNoLimit, {}, "CLASS ..."},
    {"min-height", "Search", "m",
     "List or merge only primitives that are at least this high",
     [](O& o) -> auto& { return o.least_height_m; }, 0, 1000},
    {"max-height", "Search", "m", "List or merge only primitives that are at most this high",
     [](O& o) -> auto& { return o.most_height_m; }, 0, 1000},
    {"min-width", "Search", "m",
     "List or merge only primitives whose box is at least this long (its longer side)",
     [](O& o) -> auto& { return o.least_width_m; }, 0, 1000},
    {"max-width", "Search", "m",
     "List or merge only primitives whose box is at most this long (its longer side)",
     [](O& o) -> auto& { return o.most_width_m; }, 0, 1000},
    {"site", "Search", "", "List or merge only primitives of this site",
     [](O& o) -> auto& { return o.site; }, -kNoLimit, kNoLimit, {}, "NAME"},
    {"season", "Search", "", "List or merge only primitives of this season",
     [](O& o) -> auto& { return o.season; }, -kNoLimit, kNoLimit, {}, "NAME"},
    {"sensor", "Search", "", "List or merge only primitives that this sensor measured",
     [](O& o) -> auto& { return o.sensor; }, -kNoLimit, kNoLimit, {}, "NAME"},
    {"name", "Search", "", "List or merge only primitives whose given name has this text",
     [](O& o) -> auto& { return o.name; }, -kNoLimit, kNoLimit, {}, "TEXT"},
    {"of-site", "Merge", "", "Name of the site of each set, or one name for all sets",
     [](O& o) -> auto& { return o.of_site; }, -kNoLimit, kNoLimit, {}, "NAME ..."},
    {"of-season", "Merge", "",
     "Season in which the log of each set was recorded, or one season for all sets",
     [](O& o) -> auto& { return o.of_season; }, -kNoLimit, kNoLimit, {}, "NAME ..."},
    {"of-license", "Merge", "", "Licence of the log of each set, or one licence for all sets",
     [](O& o) -> auto& { return o.of_license; }, -kNoLimit, kNoLimit, {}, "NAME ..."},
    {"edits", "Merge", "",
     "List of edits of the one set: primitives thrown out, other classes, and names",
     [](O& o) -> auto& { return o.edits; }, -kNoLimit, kNoLimit, {}, "FILE.json"},
    {"keep-duplicates", "Merge", "", "Keep several primitives of one plant",
     [](O& o) -> auto& { return o.keep_duplicates; }},
  };
// clang-format on
return kOptions;
}

std::vector<Found> find_primitives(const PrimitiveSet& set, const Options& o) {
  check_classes(o.classes);
  std::vector<Found> out;
  const auto is_wanted = [](const std::string& wanted, const std::string& text) {
    return wanted.empty() || wanted == text;
  };
  for (size_t k = 0; k < set.entries.size(); ++k) {
    const primitives::PrimitiveEntry& e = set.entries[k];
    Found f{k, e.name, e.box.max.z(), e.box.size().head<2>().maxCoeff(), {}, e.given_name};
    if (e.origin < set.origins.size()) f.origin = set.origins[e.origin];
    if (is_among(e.label, o.classes) && f.height_m >= o.least_height_m &&
        f.height_m <= o.most_height_m && f.width_m >= o.least_width_m &&
        f.width_m <= o.most_width_m && is_wanted(o.site, f.origin.site) &&
        is_wanted(o.season, f.origin.season) && is_wanted(o.sensor, f.origin.sensor) &&
        f.given_name.find(o.name) != std::string::npos) {
      out.push_back(std::move(f));
    }
  }
  return out;
}

Merged merge_sets(std::span<const std::filesystem::path> folders, const Options& o) {
  check_options("primitives", library::options(), o);
  require(!folders.empty(), "primitives: there is no set to merge");
  if (!o.edits.empty() && folders.size() > 1) {
    throw std::invalid_argument(
        "primitives: --edits takes one set: merge the sets first, then edit the library");
  }
  Merger merger(o);
  EditCounts edits;
  std::optional<double> cell_m;
  for (size_t k = 0; k < folders.size(); ++k) {
    PrimitiveSet set = primitives::read_primitive_set(folders[k]);
    if (!o.edits.empty()) edits = apply_edits(set, std::filesystem::path(o.edits));
    if (!cell_m) cell_m = set.cell_m;
    if (set.cell_m != *cell_m) {
      throw FormatError(folders[k].string(), "cell_m",
                        "the cells of patches are not as large as those of the first set");
    }
    primitives::PrimitiveOrigin origin;
    origin.site = text_of_set(o.of_site, k, folders.size(), "--of-site");
    origin.season = text_of_set(o.of_season, k, folders.size(), "--of-season");
    origin.license = text_of_set(o.of_license, k, folders.size(), "--of-license");
    merger.add(set, origin);
  }
  Merged out = std::move(merger).finish();
  out.cell_m = *cell_m;
  out.edits = edits;
  return out;
}

}  // namespace underbrush::library
