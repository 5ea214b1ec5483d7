/// Uses the library as a program of somebody else would, through `pipeline`:
///   answer_of_library simulate MODEL LIKE OUTPUT SEED DRAW
///   answer_of_library fit LOG OUTPUT
///   answer_of_library score REAL SIMULATED MODEL
/// `simulate` writes the log OUTPUT and its ranges (m, 32-bit floats; infinite for a miss) to
/// OUTPUT.ranges, `fit` writes the model OUTPUT, and `score` prints the scores as JSON.
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/score_json.inl"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace {

using namespace underbrush;

void simulate_log_of(const std::string& model, const std::string& like, const std::string& output,
                     const std::string& seed, const std::string& draw) {
  pipeline::SimulateOptions options;
  options.seed = std::stoull(seed);
  if (!draw.empty()) options.draw = draw;
  const pipeline::TracedWorld world(pipeline::read_world(model), pipeline::matter_of(options));
  pipeline::Simulation simulation(world, options);
  io::BeamReader log(like);
  const BeamLog simulated = pipeline::simulate_log(simulation, log);
  io::export_log(output, simulated);
  std::ofstream(output + ".ranges", std::ios::binary)
      .write(reinterpret_cast<const char*>(simulated.range_m.data()),
             std::streamsize(simulated.range_m.size() * sizeof(float)));
}

void fit_to(const std::string& log, const std::string& output) {
  io::LogReader beams(log);
  elements::write_model(output, pipeline::fit_model({beams}, {}).model);
}

void score_of(const std::string& real, const std::string& simulated, const std::string& model) {
  const auto opened = [](const std::string& log) {
    return [log] { return std::make_unique<io::BeamReader>(log); };
  };
  const pipeline::Scores scores = pipeline::score_logs(
      {opened(real),
       {},
       {{"library", simulated, opened(simulated),
         [&] {
           return std::make_shared<const pipeline::TracedWorld>(pipeline::open_world(model));
         }}}},
      {});
  std::puts(pipeline::json_of_scores(scores, "{}").dump().c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "";
  try {
    if (verb == "simulate" && argc == 7) {
      simulate_log_of(argv[2], argv[3], argv[4], argv[5], argv[6]);
    } else if (verb == "fit" && argc == 4) {
      fit_to(argv[2], argv[3]);
    } else if (verb == "score" && argc == 5) {
      score_of(argv[2], argv[3], argv[4]);
    } else {
      return 2;
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
