/// \file
/// The verb `annotate`: a labelled log in, or nothing for a generated site, and an annotation out.
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/generate.hpp"
#include "underbrush/primitives/measure.hpp"
#include "underbrush/regions/site_folder.hpp"

namespace underbrush::pipeline {

/// The options of `annotate`.
struct AnnotateOptions {
  std::string generate;  ///< The kind of the site that is generated; "" = a log is read.
  std::vector<double> size_m{200, 200};  ///< The sides of a generated ground along x and y.
  double ground_spacing_m = 1;
  double part_m = 0;  ///< m; the side of the parts of a generated site; 0 = it is not cut.
  primitives::MeasureOptions measure;
  /// Density, margin and seed of a generated site; the kind and the cell are those above.
  primitives::GenerateOptions site;
};

/// The options of `annotate`.
std::span<const Option<AnnotateOptions>> annotate_options();

/// The objects of a site, and the ground on which they stand.
struct AnnotatedSite {
  primitives::MeasuredObjects measured;
  elements::Model ground;
  bool has_own_ground = true;  ///< Whether the ground was made from the log or generated.
};

/// Lists the objects of a labelled log, which messages call `file`, or of a site that is generated
/// where `log` is null. They stand on the ground of the model in the folder `ground`, or where that
/// is empty on the ground of the log or on a generated one. `progress(stage, done, total)` may be
/// empty. Throws `FormatError`, and `std::invalid_argument` for options out of range and unless
/// there is either a log or a kind.
AnnotatedSite annotate_site(
    const std::string& file, BeamSource* log, const std::string& ground,
    const AnnotateOptions& options,
    const std::function<void(std::string_view, size_t, size_t)>& progress = {});

/// Generates a site and writes it in parts (`regions::generate_site`). Throws as `annotate_site`
/// does, and `IoError`.
regions::GeneratedSite generate_parts(const std::filesystem::path& output,
                                      const AnnotateOptions& options, const std::string& provenance,
                                      const regions::PartProgress& progress = {});

/// Writes the annotation `output`, which names the folder `ground`. A new ground is written to that
/// folder; either both appear or none. Throws `IoError`.
void write_annotated(const std::filesystem::path& output, const std::filesystem::path& ground,
                     AnnotatedSite site, const std::string& provenance);

}  // namespace underbrush::pipeline
