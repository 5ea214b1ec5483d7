/// \file
/// The verb `extract`: a model and the labelled log that it was fitted to in, primitives out.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/primitives/extract.hpp"

namespace underbrush::pipeline {

/// The options of `extract`.
struct ExtractOptions {
  std::string elements = "own";  ///< "own" or "box".
  primitives::ExtractOptions cut;
};

/// The options of `extract`.
std::span<const Option<ExtractOptions>> extract_options();

/// Reads a model, or of the world of regions of a model the part that `extract_primitives` cuts
/// primitives out of, along a labelled log, which is read once. Throws `FormatError`, also for a
/// scene's world, and as `primitives::extract` does.
elements::Model read_model_along(const std::filesystem::path& path, BeamSource& labelled,
                                 const ExtractOptions& options);

/// Cuts primitives out of a model along a labelled log, which messages call `file`. Throws
/// `FormatError` for a log without objects or whose objects hold no element of the model,
/// `DataError` for a model without ground, and as `primitives::extract` does.
primitives::ExtractResult extract_primitives(const elements::Model& model, const std::string& file,
                                             BeamSource& labelled, const ExtractOptions& options,
                                             const primitives::MeasureProgress& progress = {});

}  // namespace underbrush::pipeline
