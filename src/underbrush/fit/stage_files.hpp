/// \file
/// The files that the stages of a fit leave to each other.
#pragma once
#include <filesystem>

#include "underbrush/fit/fit_stages.hpp"

namespace underbrush::fit {

/// Writes the start of a fit and its refinement as a folder. Throws `IoError`.
void write_start(const std::filesystem::path& folder, const FitStart& start,
                 const likelihood::Refinement& refinement, const FitOptions& options);
/// Reads the start of a fit. Throws `FormatError`.
FitStart read_start(const std::filesystem::path& folder);

/// Writes a refinement as a folder. Throws `IoError`.
void write_refinement(const std::filesystem::path& folder,
                      const likelihood::Refinement& refinement);
/// Reads a refinement, from its folder or from that of the start. Throws `FormatError`.
likelihood::Refinement read_refinement(const std::filesystem::path& folder);

/// Writes the sums of some rows: those of elements that their beams met. Throws `IoError`.
void write_sums(const std::filesystem::path& file, const likelihood::PassSums& sums);
/// Adds the sums of a file, which must be of as many elements as `sums`. Throws `FormatError`.
void add_sums(const std::filesystem::path& file, likelihood::PassSums& sums);

}  // namespace underbrush::fit
