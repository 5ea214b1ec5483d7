#include "studies/sequential.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/perception/object_list_file.hpp"
#include "underbrush/pipeline/reports_json.inl"

namespace underbrush::studies {
namespace {

using perception::ComparedObject;
using perception::kComparedValues;
using perception::ListScore;
using perception::ObjectList;
using perception::TrackedObject;

constexpr const char* kHidden = "intersection: hidden car, ";

double& value_of(TrackedObject& o, size_t k) {
  return k < 3 ? o.box.centre_m[int(k)] : o.box.size_m[int(k) - 3];
}

}  // namespace

std::array<ValueComparison, 6> value_comparison(const std::vector<ComparedObject>& objects) {
  std::array<ValueComparison, 6> out{};
  double n = 0;
  for (const ComparedObject& o : objects) {
    if (std::min(o.simulated_real.cycles, o.real_truth.cycles) < kLeastCycles) continue;
    ++n;
    for (size_t k = 0; k < out.size(); ++k) {
      out[k].candidate_m += o.simulated_real.rmse_m[k];
      out[k].truth_m += o.real_truth.rmse_m[k];
    }
  }
  for (ValueComparison& v : out) {
    v.candidate_m /= n;
    v.truth_m /= n;
  }
  return out;
}

std::vector<Check> list_checks(const std::string& name,
                               const std::vector<ComparedObject>& simulated,
                               const std::vector<ComparedObject>& baseline) {
  std::vector<Check> checks;
  const auto sim = value_comparison(simulated), noise = value_comparison(baseline);
  for (size_t k = 3; k < sim.size(); ++k) {
    checks.push_back({fmt::format("{}: RMSE of the {} against real, over that of the truth", name,
                                  kComparedValues[k]),
                      sim[k].candidate_m / sim[k].truth_m, 0.5});
  }
  for (size_t k = 0; k < sim.size(); ++k) {
    checks.push_back({fmt::format("{}: RMSE of {} against real, over that of the noisy truth", name,
                                  kComparedValues[k]),
                      sim[k].candidate_m / noise[k].candidate_m, 1});
  }
  return checks;
}

std::vector<ObjectList> noisy_truth(const std::vector<ObjectList>& truth,
                                    const std::vector<ObjectList>& real, uint64_t seed) {
  const ListScore score = perception::score_lists(real, truth);
  std::array<double, 6> squares{};
  double n = 0;
  for (const auto& followed : score.followed) {
    for (const auto& m : followed.moments) {
      if (!m.found) continue;
      ++n;
      TrackedObject a = m.reference, b = *m.found;
      for (size_t k = 0; k < squares.size(); ++k) {
        squares[k] += std::pow(value_of(a, k) - value_of(b, k), 2);
      }
    }
  }
  std::vector<ObjectList> out = truth;
  Stream random(seed);
  for (ObjectList& list : out) {
    for (TrackedObject& o : list.objects) {
      for (size_t k = 0; k < squares.size(); ++k) {
        double& v = value_of(o, k);
        v += std::sqrt(squares[k] / std::max(n, 1.0)) * random.normal();
        if (k >= 3) v = std::max(v, 0.05);
      }
    }
  }
  return out;
}

Absence absence_of(const std::vector<ObjectList>& lists, const std::vector<ObjectList>& truth,
                   uint64_t id) {
  Absence out;
  bool was_there = false;
  const ListScore score = perception::score_lists(lists, truth);
  for (const auto& followed : score.followed) {
    if (followed.id != id) continue;
    for (int k = 0; k < int(followed.moments.size()); ++k) {
      const bool is_there = followed.moments[size_t(k)].found.has_value();
      if (was_there && !is_there && out.lost < 0) out.lost = k;
      if (out.lost >= 0 && is_there && out.found < 0) out.found = k;
      was_there = was_there || is_there;
    }
  }
  return out;
}

perception::PerceptionSetup measured_setup(bool is_model) {
  perception::PerceptionSetup setup;
  setup.is_model = is_model;
  setup.model.track.completion.enabled = setup.real.track.completion.enabled = false;
  return setup;
}

void run_intersection(const StudyRun& run, StudyResult& out) {
  const Intersection scene = make_intersection();
  run.say("intersection: scan");
  const BeamLog log = scan_intersection(scene, run.quick ? 0 : 9, run.quick ? 0 : 41, run.seed);
  const perception::LogTruth truth(scene.truth);
  std::vector<report::NamedLists> lists;
  std::vector<ObjectList> reference;
  std::vector<ListScore> scores;
  for (const bool is_model : {true, false}) {
    perception::PerceptionSetup setup = measured_setup(is_model);
    setup.rig = scene.rig;
    MemorySource source(log);
    perception::PerceivedLog made = perception::perceived(source, &truth, setup);
    reference = made.truth;
    scores.push_back(perception::score_lists(made.lists, reference));
    lists.push_back({is_model ? "model" : "pipeline", std::move(made.lists)});
  }
  const Absence model = absence_of(lists[0].lists, reference, kTurningCar);
  const Absence real = absence_of(lists[1].lists, reference, kTurningCar);
  for (const auto& [name, a] : {std::pair{"model", model}, {"pipeline", real}}) {
    out.figures["intersection"][name] = {{"lost", a.lost}, {"found", a.found}};
  }
  const auto apart = [](int a, int b) { return a < 0 || b < 0 ? NAN : std::abs(a - b); };
  out.checks.push_back(
      {std::string(kHidden) + "cycles between the two losses", apart(model.lost, real.lost), 1});
  out.checks.push_back(
      {std::string(kHidden) + "cycles between the two returns", apart(model.found, real.found), 1});
  out.tables.push_back(report::table_of("the truth of the intersection",
                                        std::vector<std::string>{"model", "pipeline"}, scores));
  const auto rows = perception::compare_lists(lists[0].lists, lists[1].lists, reference);
  out.tables.push_back(report::table_of(rows, "model", "pipeline"));
  out.figures["intersection"]["normalised_rmse"] = pipeline::json_of(rows);
  out.notes.push_back(fmt::format(
      "intersection: the hidden car is lost in cycle {} by the model and {} by the pipeline, and "
      "found again in cycle {} and {}, of {}",
      model.lost, real.lost, model.found, real.found, reference.size()));
  out.pictures += report::list_pictures({"truth", reference}, lists);
}

}  // namespace underbrush::studies
