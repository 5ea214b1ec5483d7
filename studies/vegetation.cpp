#include "studies/vegetation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/pipeline/fit_model.hpp"

namespace underbrush::studies {
namespace {

/// A row of Table I of [deschaud12], and the least factor surface / volumetric that the check
/// demands.
struct Published {
  const char *target, *title;
  double surface, volumetric, factor;
};
constexpr Published kTableI[] = {{"planes", "Plane", 0.019, 0.068, 0},
                                 {"tree_high", "High density tree", 0.111, 0.074, 1.5},
                                 {"tree_medium", "Medium density tree", 0.896, 0.125, 7},
                                 {"tree_low", "Low density tree", 0.622, 0.054, 11},
                                 {"tall_grass", "Tall grass", 0.888, 0.095, 9},
                                 {"short_grass", "Short grass", 1.229, 0.091, 13}};
constexpr double kPlaneLimit = 0.02;

const Published& published(const std::string& target) {
  return *std::find_if(std::begin(kTableI), std::end(kTableI),
                       [&](const Published& p) { return target == p.target; });
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double surface_distance(const std::vector<Contender>& contenders, const TargetScores& target) {
  double least = INFINITY;
  for (const Contender& c : contenders) {
    if (is_surface(c)) least = std::min(least, target.scores.at(c.name).distance);
  }
  return least;
}

/// The limit of the planes needs all measurements, also in a quick study.
StaticScanOptions scan_options(const StudyRun& run, const std::string& target) {
  StaticScanOptions options;
  options.seed = run.seed;
  if (run.quick) {
    options.bearings = 10;
    options.most_lasers = 3;
    if (target != "planes") options.measurements = 500;
    options.margin_lasers = 1;
    options.margin_bearings = 2;
  }
  return options;
}

/// Returns the scores of all contenders on one target, and adds its pictures.
TargetScores score_target(const StudyRun& run, const StaticScan& scan,
                          const std::vector<Contender>& contenders, std::string& pictures,
                          const std::function<void(elements::Model&)>& change) {
  using metrics::BearingRangeHistogram;
  TargetScores out{scan.target, scan.porous, scan.directions, scan.train.size(), scan.test.size(),
                   {},          {}};
  const BearingRangeHistogram real = histogram_of(scan, scan.test);
  const BeamLog known = without_margin(scan);
  out.baselines = {
      {"look-up", bhattacharyya_distance(real, histogram_of(scan, known))},
      {"always hit",
       bhattacharyya_distance(real, histogram_of(scan, metrics::always_hit(known, scan.test)))}};
  std::map<std::string, BearingRangeHistogram> simulated;
  elements::Model model;
  StaticScore score;
  for (size_t k = 0; k < contenders.size(); ++k) {
    const Contender& c = contenders[k];
    const auto model_of = [](const Contender& x) {
      return x.fit.fitter + "-" + x.fit.credit.rule + "-" + x.fit.segment.method +
             (x.name.starts_with(kDefault) ? "-default" : "");
    };
    const bool same_model = k > 0 && model_of(contenders[k - 1]) == model_of(c);
    if (!same_model) {
      const auto start = std::chrono::steady_clock::now();
      MemorySource train(scan.train);
      model = pipeline::fit_model({train}, c.fit).model;
      score.fit_seconds = seconds_since(start);
      score.elements = model.size();
      if (change && !is_surface(c)) change(model);
      if (!run.keep.empty()) write_model(run.keep / (scan.target + "-" + model_of(c)), model);
    }
    BearingRangeHistogram h =
        simulated_histogram(scan, model, c.random_ray, c.once, run.quick ? 4 : 10, run.seed + 1);
    score.distance = bhattacharyya_distance(real, h);
    score.mean_of_lasers = mean_distance_of_lasers(real, h);
    out.scores[c.name] = score;
    simulated.emplace(c.name, std::move(h));
  }
  std::vector<NamedHistogram> shown{{"measured", &real}};
  for (const char* name : {"surface, cone", kDefault, "likelihood"}) {
    shown.push_back({name, &simulated.at(name)});
  }
  pictures += histogram_figures(scan.target, shown);
  return out;
}

report::Table distance_table(const std::vector<Contender>& contenders,
                             const std::vector<TargetScores>& targets) {
  report::Table table;
  table.title = "Bhattacharyya distance, simulated against measured (Table I)";
  table.caption =
      "D = −ln Σ √(p q) over laser × bearing × range bins of 0.09° × 2 mm and a no-return bin, all "
      "lasers normalised together. Default: as simulate answers; all others: drawn anew for each "
      "beam, as in the paper. Published: real targets of Deschaud et al. 2012; ours are generated. "
      "Look-up: the training fifth as the simulation. Always hit: each beam at the median range of "
      "its laser in that fifth. Axis, cone: where the ray is drawn.";
  table.head = {"model"};
  std::vector<std::string> surface{"published surface"}, volumetric{"published volumetric"},
      look_up{"look-up"}, always_hit{"always hit"};
  for (const TargetScores& t : targets) {
    const Published& p = published(t.target);
    table.head.emplace_back(p.title);
    surface.push_back(fmt::format("{:.3f}", p.surface));
    volumetric.push_back(fmt::format("{:.3f}", p.volumetric));
    look_up.push_back(fmt::format("{:.4f}", t.baselines.at("look-up")));
    always_hit.push_back(fmt::format("{:.4f}", t.baselines.at("always hit")));
  }
  table.rows = {surface, volumetric, look_up, always_hit};
  for (const Contender& c : contenders) {
    table.rows.push_back({c.name});
    for (const TargetScores& t : targets) {
      table.rows.back().push_back(fmt::format("{:.4f}", t.scores.at(c.name).distance));
    }
  }
  return table;
}

report::Table size_table(const std::vector<Contender>& contenders,
                         const std::vector<TargetScores>& targets, double sensor_beams_per_s) {
  report::Table table{"Elements and fitting speed",
                      "Speed: training beams a second over what the sensor fires.",
                      {"model", "elements, all targets", "× sensor's rate"},
                      {}};
  for (const Contender& c : contenders) {
    size_t elements = 0, beams = 0;
    double seconds = 0;
    for (const TargetScores& t : targets) {
      elements += t.scores.at(c.name).elements;
      seconds += t.scores.at(c.name).fit_seconds;
      beams += t.train_beams;
    }
    table.rows.push_back({c.name, std::to_string(elements),
                          fmt::format("{:.3g}", double(beams) / seconds / sensor_beams_per_s)});
  }
  return table;
}

Json json_of(const TargetScores& t) {
  Json out{{"directions", t.directions},
           {"train_beams", t.train_beams},
           {"test_beams", t.test_beams},
           {"baselines", t.baselines}};
  for (const auto& [name, s] : t.scores) {
    out["models"][name] = {{"distance", std::isfinite(s.distance) ? Json(s.distance) : Json()},
                           {"mean_of_lasers", s.mean_of_lasers},
                           {"elements", s.elements},
                           {"fit_seconds", s.fit_seconds},
                           {"fit_beams_per_s", double(t.train_beams) / s.fit_seconds}};
  }
  return out;
}

}  // namespace

bool is_surface(const Contender& contender) {
  return contender.fit.fitter == "rimls" || contender.fit.fitter == "surface";
}

std::vector<Check> static_checks(const std::vector<Contender>& contenders,
                                 const std::vector<TargetScores>& targets) {
  std::vector<Check> checks;
  for (const TargetScores& t : targets) {
    const double distance = t.scores.at(kDefault).distance;
    if (!t.porous) {
      checks.push_back(
          {fmt::format("{} on {}, distance", kDefault, t.target), distance, kPlaneLimit});
      continue;
    }
    checks.push_back({fmt::format("{} on {}, surface / volumetric", kDefault, t.target),
                      surface_distance(contenders, t) / distance, published(t.target).factor,
                      false});
  }
  return checks;
}

void add_static_targets(const StudyRun& run, const std::vector<std::string>& names,
                        StudyResult& result, const std::function<void(elements::Model&)>& change) {
  const std::vector<Contender> contenders = static_contenders(run.seed);
  std::vector<TargetScores> targets;
  double rate = 1;
  for (const std::string& name : names) {
    const StaticScan scan = scan_target(name, scan_options(run, name));
    rate = scan.sensor.beams_per_s();
    run.say(fmt::format("{}: {} directions, {} beams train, {} test", name, scan.directions,
                        scan.train.size(), scan.test.size()));
    if (!run.keep.empty()) {
      std::filesystem::create_directories(run.keep);
      for (const auto& [part, beams] : {std::pair{"train", &scan.train}, {"test", &scan.test}}) {
        MemorySource source(*beams);
        io::export_log(run.keep / fmt::format("{}-{}.ply", name, part), source, "", "{}");
      }
    }
    targets.push_back(score_target(run, scan, contenders, result.pictures, change));
    result.figures["static"][name] = json_of(targets.back());
  }
  result.tables.push_back(distance_table(contenders, targets));
  result.tables.push_back(size_table(contenders, targets, rate));
  for (const Check& c : static_checks(contenders, targets)) result.checks.push_back(c);
}

}  // namespace underbrush::studies
