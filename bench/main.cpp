// Runs the benchmark whose name the program was called by.
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "programs.hpp"

int main(int argc, char** argv) {
  using namespace underbrush::bench;  // NOLINT(google-build-using-namespace)
  const std::map<std::string, Program*> programs{{"bench_echoes", bench_echoes},
                                                 {"bench_fitters", bench_fitters},
                                                 {"bench_fmu", bench_fmu},
                                                 {"bench_log_formats", bench_log_formats},
                                                 {"bench_octree", bench_octree},
                                                 {"bench_perception", bench_perception},
                                                 {"bench_pipeline", bench_pipeline},
                                                 {"bench_trace", bench_trace},
                                                 {"bench_triangles", bench_triangles},
                                                 {"bench_waveform", bench_waveform}};
  const auto chosen = programs.find(std::filesystem::path(argv[0]).filename().string());
  if (chosen != programs.end()) return chosen->second(argc, argv);
  std::fprintf(stderr, "call this program by the name of a benchmark:\n");
  for (const auto& [name, run] : programs) std::fprintf(stderr, "  %s\n", name.c_str());
  return 2;
}
