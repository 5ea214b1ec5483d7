/// \file
/// The verb `annotate`: a labelled log in, or nothing for a generated site, and an annotation out.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/measure.hpp"
#include "underbrush/regions/site_folder.hpp"
#include "underbrush/sites/generate.hpp"
#include "underbrush/sites/like_site.hpp"

namespace underbrush::pipeline {

/// The options of `annotate`.
struct AnnotateOptions {
  /// The kind of the site that is generated, "" = a log is read; "like" or "" with `like`.
  std::string generate;
  std::string like;        ///< The annotation of the site that a generated one is like.
  std::string primitives;  ///< A set of primitives: only their classes are generated.
  size_t draws = 20;       ///< Sites for the intervals of statistics; 0 = no statistics.
  std::vector<double> size_m{200, 200};  ///< The sides of a generated ground along x and y.
  double ground_spacing_m = 1;
  double part_m = 0;  ///< m; the side of the parts of a generated site; 0 = it is not cut.
  primitives::MeasureOptions measure;
  /// Density, margin and seed of a generated site; the kind and the cell are those above.
  sites::GenerateOptions site;
};

/// The options of `annotate`.
std::span<const Option<AnnotateOptions>> annotate_options();

/// The objects of a site, and the ground on which they stand.
struct AnnotatedSite {
  primitives::MeasuredObjects measured;
  elements::Model ground;
  bool has_own_ground = true;  ///< Whether the ground was made from the log or generated.
  /// Counts of a site that is generated; its objects are in `measured`.
  std::optional<sites::DrawnSite> drawn;
  /// Statistics of the site `like` beside those of sites drawn on its ground.
  std::vector<sites::ComparedStatistic> statistics;
  std::vector<std::filesystem::path> inputs;  ///< Files and folders that options name.
};

/// Lists the objects of a labelled log, which messages call `file`, or of a site that is generated
/// where `log` is null. They stand on the ground of the model in the folder `ground`, or where that
/// is empty on the ground of the log or on a generated one. `progress(stage, done, total)` may be
/// empty. Throws `FormatError`, and `std::invalid_argument` for options out of range and unless
/// there is one of a log, a kind and a site that the new one is like.
AnnotatedSite annotate_site(
    const std::string& file, BeamSource* log, const std::string& ground,
    const AnnotateOptions& options,
    const std::function<void(std::string_view, size_t, size_t)>& progress = {});

/// Generates a site and writes it in parts (`regions::generate_site`). Throws as `annotate_site`
/// does, and `IoError`.
regions::GeneratedSite generate_parts(const std::filesystem::path& output,
                                      const AnnotateOptions& options, const std::string& provenance,
                                      const regions::PartProgress& progress = {});

}  // namespace underbrush::pipeline
