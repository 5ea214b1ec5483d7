/// \file
/// The tables and pictures of the study of [kim12].
#pragma once
#include <string>
#include <vector>

#include "studies/verification.hpp"

namespace underbrush::studies {

/// Returns the planes of the real cloud, as in [kim12] table 3; with `published` the paper's beside
/// them.
report::Table plane_table(const std::string& title, const PairFigures& f, bool published);
/// Returns the distances from the planes, as in [kim12] table 4.
report::Table distance_table(const std::string& title, const PairFigures& f, bool published);
/// Returns the differences of the range histograms of pairs of clouds, by both registrations.
report::Table histogram_table(const std::string& title, const std::vector<std::string>& names,
                              const std::vector<const PairFigures*>& all);
/// Returns the figures of a pair as JSON.
Json json_of(const PairFigures& f);
/// Returns the two histograms, as counts and shares, in HTML.
std::string histogram_picture(const std::string& title, const RangeHistograms& h);

}  // namespace underbrush::studies
