#include "underbrush/pipeline/extract_primitives.hpp"

#include <algorithm>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/regions/world_folder.hpp"

namespace underbrush::pipeline {
namespace {

/// The squares, seen from above (m, world), in which the boxes of the objects of a log lie, however
/// these are turned.
std::map<uint32_t, Eigen::AlignedBox2d> squares_of_objects(BeamSource& labelled, double margin_m) {
  std::map<uint32_t, Eigen::AlignedBox2d> squares;
  primitives::for_each_object_hit(labelled, [&](const primitives::ObjectHit& hit) {
    squares[hit.instance].extend(hit.point.head<2>());
  });
  for (auto& [instance, square] : squares) {
    const Eigen::Vector2d beside = Eigen::Vector2d::Constant(square.diagonal().norm() + margin_m);
    square = {square.min() - beside, square.max() + beside};
  }
  return squares;
}

}  // namespace

std::span<const Option<ExtractOptions>> extract_options() {
  using O = ExtractOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"box-quantile", "More options", "",
     "Fit each box to the points between the quantiles X and 1 − X along each axis; 0 = all points "
     "(the code of the authors of [tallavajhula18] has 0.05)",
     [](O& o) -> auto& { return o.cut.measure.quantile; }, 0, 0.49},
    {"elements", "More options", "",
     "Which elements belong to an object: box = all whose centres lie in its box; own = elements "
     "in the box that also lie among the object's points",
     [](O& o) -> auto& { return o.elements; }, -kNoLimit, kNoLimit, {"own", "box"}},
    {"free-space-below", "More options", "",
     "Leave out ellipsoids that stopped less than this share of the beams that met them",
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

elements::Model read_model_along(const std::filesystem::path& path, BeamSource& labelled,
                                 const ExtractOptions& options) {
  if (!regions::is_world(path)) return elements::read_model(path);
  const regions::WorldFolder world(path);
  if (world.index().is_scene) {
    throw FormatError(path.string(), "",
                      "the world is one of a scene, which was not fitted to a log");
  }
  const double margin_m = 1 + 2 * options.cut.measure.cell_m;
  std::vector<uint32_t> needed;
  const auto squares = squares_of_objects(labelled, margin_m);
  for (uint32_t k = 0; k < world.index().regions.size(); ++k) {
    const Eigen::AlignedBox3d& box = world.index().regions[k].bounds;
    const Eigen::AlignedBox2d region(box.min().head<2>(), box.max().head<2>());
    const auto is_met = [&](const auto& square) { return square.second.intersects(region); };
    if (std::ranges::any_of(squares, is_met)) needed.push_back(k);
  }
  return std::move(world.part(needed).scene.models[0]);
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
