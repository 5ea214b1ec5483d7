#include "underbrush/pipeline/extract_primitives.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::pipeline {
namespace {}  // namespace

std::span<const Option<ExtractOptions>> extract_options() {
  using O = ExtractOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"box-quantile", "More options", "",
     "Fit boxes to the points from this quantile to 1 − it along each axis; 0 = all points (0.05 in "
     "the code of [tallavajhula18]'s authors)",
     [](O& o) -> auto& { return o.cut.measure.quantile; }, 0, 0.49},
    {"elements", "More options", "",
     "Elements that an object takes: all those centred in its box, or only its own, which lie among "
     "its points",
     [](O& o) -> auto& { return o.elements; }, -kNoLimit, kNoLimit, {"own", "box"}},
    {"free-space-below", "More options", "",
     "Leave out ellipsoids at which a smaller share of the beams that met them ended",
     [](O& o) -> auto& { return o.cut.free_space_below; }, 0, 1},
    {"patch-cell", "More options", "m", "Side of the cells that patches of shrubs are cut into",
     [](O& o) -> auto& { return o.cut.measure.cell_m; }, 0.05, 1000},
    {"min-elements", "More options", "", "Leave out objects and cells with fewer elements",
     [](O& o) -> auto& { return o.cut.min_elements; }, 1, 1e6},
    {"min-points", "More options", "", "Leave out objects and cells with fewer points",
     [](O& o) -> auto& { return o.cut.measure.min_points; }, 1, 1e6},
  };
// clang-format on
return kOptions;
}

primitives::ExtractResult extract_primitives(const elements::Model& model, const std::string& file,
                                             BeamSource& labelled, const ExtractOptions& options,
                                             const primitives::MeasureProgress& progress) {
  check_options("extract", extract_options(), options);
  primitives::require_objects(file, labelled);
  require_data(model.ground.size() > 0, "the model has no ground");
  primitives::ExtractOptions cut = options.cut;
  cut.membership =
      options.elements == "box" ? primitives::Membership::kBox : primitives::Membership::kOwn;
  primitives::ExtractResult out = primitives::extract(model, labelled, cut, progress);
  if (out.primitives.empty()) {
    throw FormatError(file, "", "none of its objects holds an element of the model");
  }
  return out;
}

}  // namespace underbrush::pipeline
