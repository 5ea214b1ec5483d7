/// Answers the beams of a log by a model as a program of somebody else would, through `pipeline`.
/// Writes the log OUTPUT and its ranges (m, 32-bit floats; infinite for a miss) to OUTPUT.ranges:
///   answer_of_library MODEL LIKE OUTPUT SEED DRAW
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

int main(int argc, char** argv) {
  using namespace underbrush;
  if (argc != 6) return 2;
  try {
    pipeline::SimulateOptions options;
    options.seed = std::stoull(argv[4]);
    if (*argv[5]) options.draw = argv[5];
    const pipeline::TracedWorld world(pipeline::read_world(argv[1]), pipeline::matter_of(options));
    pipeline::Simulation simulation(world, options);
    io::BeamReader like(argv[2]);
    const BeamLog log = pipeline::simulate_log(simulation, like);
    io::export_log(argv[3], log);
    std::ofstream(std::string(argv[3]) + ".ranges", std::ios::binary)
        .write(reinterpret_cast<const char*>(log.range_m.data()),
               std::streamsize(log.range_m.size() * sizeof(float)));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
