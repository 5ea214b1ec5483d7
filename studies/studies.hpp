/// The function of each study. A new study also needs a line in studies.cpp.
#pragma once
#include "studies/study.hpp"

namespace underbrush::studies {

StudyResult study_echoes(const StudyRun& run);
StudyResult study_extrapolation(const StudyRun& run);
StudyResult study_look_up(const StudyRun& run);
StudyResult study_mesh_fidelity(const StudyRun& run);
StudyResult study_primitives(const StudyRun& run);
StudyResult study_scenes(const StudyRun& run);
StudyResult study_sequential(const StudyRun& run);
StudyResult study_transfer(const StudyRun& run);
StudyResult study_transmission(const StudyRun& run);
StudyResult study_vegetation(const StudyRun& run);
StudyResult study_verification(const StudyRun& run);
StudyResult study_viewpoints(const StudyRun& run);

}  // namespace underbrush::studies
