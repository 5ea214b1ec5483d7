#include "study/studies.hpp"

namespace underbrush::app {
namespace {

constexpr Study kStudies[] = {
    {"vegetation", "Table I and the mobile experiment of Deschaud et al. 2012", study_vegetation},
    {"transfer", "Learnt from one lidar, simulated for another, on a generated site",
     study_transfer},
};

}  // namespace

std::span<const Study> studies() { return kStudies; }

}  // namespace underbrush::app
