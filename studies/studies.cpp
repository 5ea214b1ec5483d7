#include "studies/studies.hpp"

namespace underbrush::studies {
namespace {

constexpr Study kStudies[] = {
    {"vegetation", "Table I and the mobile experiment of Deschaud et al. 2012", study_vegetation},
    {"primitives", "Table II of Tallavajhula et al. 2018: primitives against plant meshes",
     study_primitives},
    {"scenes", "From a composed scene to a fit of the site itself, one truth at a time",
     study_scenes},
    {"transfer", "Learnt from one lidar, simulated for another, on a generated site",
     study_transfer},
    {"mesh-fidelity", "Leaf inclinations of Goodin et al. 2024, from billboards to fine trees",
     study_mesh_fidelity},
    {"look-up", "Real logs answered by their own training beams, the baseline of any simulator",
     study_look_up},
    {"echoes", "Several echoes a pulse, simulated by the whole instrument and held against a log",
     study_echoes},
    {"extrapolation", "Real logs answered beyond what was fitted: further on, and between rings",
     study_extrapolation},
    {"sequential", "Lists of objects of Rosenberger et al. 2020: simulated, real and true",
     study_sequential},
    {"transmission", "Slabs of leaves of known density: how dense models make them, what they pass",
     study_transmission},
    {"viewpoints", "A generated site answered from above, from aside and from among its plants",
     study_viewpoints},
    {"verification", "Histograms and planes of Kim et al. 2012, on its miniature and on real walls",
     study_verification},
};

}  // namespace

std::span<const Study> studies() { return kStudies; }

}  // namespace underbrush::studies
