#include "underbrush/pipeline/segment_log.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "underbrush/core/range_unit.hpp"
#include "underbrush/elements/label_sets.hpp"

namespace underbrush::pipeline {
namespace {

using primitives::Prior;

/// Returns the prior of each hit, which is its class in the given labels.
std::vector<Prior> priors_of(const primitives::GivenLabels& given) {
  std::vector<Prior> prior;
  for (const uint32_t label : given.label) {
    prior.push_back(elements::ground_label(given.set, label) == elements::GroundLabel::kYes
                        ? Prior::kGround
                    : elements::is_vegetation(given.set, label) ? Prior::kObject
                                                                : Prior::kOther);
  }
  return prior;
}

/// Keeps classes and instances that are given and takes the others from the search.
LabelsOfHits taken_over(const primitives::GivenLabels& given, LabelsOfHits out) {
  if (!given.label.empty() && given.set == "underbrush") {
    out.label.assign(given.label.begin(), given.label.end());
  }
  if (!given.instance.empty() && (given.set == "underbrush" || given.label.empty())) {
    out.instance = given.instance;
    out.objects = std::set<uint32_t>(given.instance.begin(), given.instance.end()).size();
    out.objects -= std::count(given.instance.begin(), given.instance.end(), 0u) > 0;
  }
  return out;
}

}  // namespace

// long: the table of the options.
std::span<const Option<SegmentOptions>> segment_options() {
  using O = SegmentOptions;
  static const std::vector<std::string> names = elements::label_set_names();
  static const std::vector<std::string_view> sets(names.begin(), names.end());
  // clang-format off
  static const Option<O> kOptions[] = {
    {"labels", "", "",
     "Take labels from this file: a SemanticKITTI .label file, or a PLY, PCD or CSV file with a "
     "column class or instance (also the log itself)",
     [](O& o) -> auto& { return o.labels; }, -kNoLimit, kNoLimit, {}, "FILE"},
    {"label-set", "", "", "Label set that gives the numbers of --labels their meaning",
     [](O& o) -> auto& { return o.label_set; }, -kNoLimit, kNoLimit, sets},
    {"truth", "", "",
     "Column of the log with the numbers of the true trees, for comparison",
     [](O& o) -> auto& { return o.truth; }},
    {"ground-method", "", "", "Method of ground segmentation",
     [](O& o) -> auto& { return o.search.ground.method; }, -kNoLimit, kNoLimit,
     {"lower_envelope", "spherical_variance"}},
    {"min-range", "", "m",
     "Give no label to returns nearer than this; they may be on the own vehicle",
     [](O& o) -> auto& { return o.search.min_range_m; }, 0, 1000},

    {"tile", "Objects", "m", "Side of a tile of the ground segmentation",
     [](O& o) -> auto& { return o.search.tile_m; }, 1, 1e6},
    {"cell", "Objects", "m", "Side of a column; 0 = 0.4, or more where points are sparse",
     [](O& o) -> auto& { return o.search.objects.cell_m; }, 0, 100},
    {"gap", "Objects", "m",
     "Empty height that separates objects in a column; 0 = by the side of the column",
     [](O& o) -> auto& { return o.search.objects.gap_m; }, 0, 100},
    {"min-points", "Objects", "", "Least number of points of an object",
     [](O& o) -> auto& { return o.search.objects.min_points; }},

    {"spacing", "Trees", "m",
     "Distance below which two tree tops are one crown; 6 % of the tree's height is added",
     [](O& o) -> auto& { return o.search.objects.spacing_a_m; }, 0, 1000},
    {"prominence", "Trees", "m",
     "Join two crowns if the dip of the canopy between their tops is less deep than this; 4 % of "
     "the tree's height is added",
     [](O& o) -> auto& { return o.search.objects.prominence_a_m; }, 0, 1000},
    {"radius", "Trees", "m",
     "Largest distance of the edge of a crown from its top; 30 % of the tree's height is added",
     [](O& o) -> auto& { return o.search.objects.radius_a_m; }, 0, 1000},
    {"foot", "Trees", "m", "Largest width of a tree's foot under its crown",
     [](O& o) -> auto& { return o.search.objects.trunk_m; }, 0, 100},

    {"tree-height", "Classes by size", "m", "Least height of a tree; lower objects are shrubs",
     [](O& o) -> auto& { return o.search.objects.sizes.tree_m; }, 0, 200},
    {"small-shrub-height", "Classes by size", "m",
     "Least height of a small shrub; lower ones are low shrubs",
     [](O& o) -> auto& { return o.search.objects.sizes.small_shrub_m; }, 0, 200},
    {"medium-tree-height", "Classes by size", "m",
     "Least height of a medium tree; lower ones are small trees",
     [](O& o) -> auto& { return o.search.objects.sizes.medium_tree_m; }, 0, 200},
    {"large-tree-height", "Classes by size", "m",
     "Least height of a large tree; lower ones are medium trees at most",
     [](O& o) -> auto& { return o.search.objects.sizes.large_tree_m; }, 0, 200},
    {"patch-side", "Classes by size", "m", "Least length of a patch of shrubs",
     [](O& o) -> auto& { return o.search.objects.sizes.patch_m; }, 0, 1000},
  };
// clang-format on
return kOptions;
}

Segmentation segment_log(BeamSource& log, const SegmentOptions& options,
                         const std::function<void(BeamSource&)>& write,
                         const primitives::SegmentProgress& progress) {
  check_options("segment", segment_options(), options);
  require_metres(log, "segment");
  Segmentation out;
  if (!options.labels.empty()) {
    primitives::GivenLabelOptions label_options;
    label_options.set = options.label_set;
    out.given = primitives::read_given_labels(options.labels, log, label_options);
  }
  // Labels of our own set with instances need no search.
  const bool whole = out.given && out.given->set == "underbrush" && !out.given->label.empty() &&
                     !out.given->instance.empty();
  LabelsOfHits labels;
  if (!whole) {
    out.found = primitives::segment_log(
        log, options.search, out.given ? priors_of(*out.given) : std::vector<Prior>{}, progress);
    labels = found_of(*out.found);
  }
  if (out.given) labels = taken_over(*out.given, std::move(labels));
  LabelledSource labelled(log, labels, LabelledCounts(options.truth, !out.given));
  if (write) {
    write(labelled);
  } else {
    for (BeamLog chunk; labelled.next(chunk);) {
    }
  }
  out.counts = labelled.counts();
  out.objects = labels.objects;
  return out;
}

}  // namespace underbrush::pipeline
