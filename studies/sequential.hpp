/// \file
/// The study of lists of objects after [rosenberger20], its parts and its thresholds.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "report/object_lists.hpp"
#include "studies/intersection.hpp"
#include "studies/study.hpp"
#include "underbrush/perception/perceive.hpp"

namespace underbrush::studies {

/// Lists that are compared with the real ones.
struct ListCandidate {
  std::string name;
  std::vector<perception::ObjectList> lists;
};

/// The means over the objects of the errors of one value: of a candidate and of the truth, both
/// against the real lists, m.
struct ValueComparison {
  double candidate_m = 0, truth_m = 0;
};
/// Computes the means for each of `perception::kComparedValues`, over the objects that all lists
/// have in at least `kLeastCycles` cycles.
std::array<ValueComparison, 6> value_comparison(
    const std::vector<perception::ComparedObject>& objects);
/// An object that lists share in fewer cycles is left out of the means.
inline constexpr size_t kLeastCycles = 10;

/// The checks that length, width and height of a simulated list are nearer to the real list than
/// the truth is, by a factor of two, and that the baseline is worse in every value.
std::vector<Check> list_checks(const std::string& name,
                               const std::vector<perception::ComparedObject>& simulated,
                               const std::vector<perception::ComparedObject>& baseline);

/// The truth with Gaussian noise, the stochastic model that the paper argues against. For each
/// value the noise has the standard deviation that the real lists have about the truth.
std::vector<perception::ObjectList> noisy_truth(const std::vector<perception::ObjectList>& truth,
                                                const std::vector<perception::ObjectList>& real,
                                                uint64_t seed);

/// The cycles in which an object of the reference is lost and found again; -1 where it is not.
struct Absence {
  int lost = -1, found = -1;
};
/// Finds the first absence of an object that was listed before.
Absence absence_of(const std::vector<perception::ObjectList>& lists,
                   const std::vector<perception::ObjectList>& truth, uint64_t id);

/// Options of the lists of a study: boxes as measured, because the software of a sensor reports
/// those.
perception::PerceptionSetup measured_setup(bool is_model);

/// Adds the generated intersection to a study.
void run_intersection(const StudyRun& run, StudyResult& out);

}  // namespace underbrush::studies
