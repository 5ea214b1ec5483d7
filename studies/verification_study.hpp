/// \file
/// The steps of the study of [kim12].
#pragma once
#include <functional>

#include "studies/verification.hpp"

namespace underbrush::studies {

/// Adds the results on the miniature. `change`, for tests, alters the solid that is simulated.
void add_miniature(const StudyRun& run, StudyResult& result,
                   const std::function<void(Solid&)>& change = {});
/// Adds the results on a user's own pair of clouds in `run.data`. Returns false if there is none.
bool add_own_pair(const StudyRun& run, StudyResult& result);

}  // namespace underbrush::studies
