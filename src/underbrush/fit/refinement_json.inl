// The report of a refinement as JSON. This file is for sources that use JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "underbrush/likelihood/likelihood.hpp"

namespace underbrush::fit {

/// Returns the steps of a refinement, for the manifest and for reports.
nlohmann::ordered_json json_of(const likelihood::LikelihoodReport& report);

}  // namespace underbrush::fit
