#include "studies/studies.hpp"
#include "studies/targets.hpp"
#include "studies/vegetation.hpp"
#include "studies/vegetation_repeats.hpp"

namespace underbrush::studies {

StudyResult study_vegetation(const StudyRun& run) {
  StudyResult result;
  result.lead =
      "Permeable Gaussian volumes against an opaque surface, learnt from the same beams: six "
      "generated targets of fine triangles before a standing HDL-64E, and the real logs given.";
  add_static_targets(run, static_target_names(), result);
  add_repeated_logs(run, result);
  add_mobile_logs(run, result);
  return result;
}

}  // namespace underbrush::studies
