// The command line that the benchmarks of perception and of the FMU share.
#pragma once
#include <time.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "underbrush/core/parallel.hpp"

namespace underbrush::bench {

using Json = nlohmann::ordered_json;

/// The time of all cores that the process has had. Unlike the time of a clock it does not count
/// what other processes do.
inline double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// Reads the options, measures, and prints the results.
inline int run(int argc, char** argv, const std::string& title, int runs,
               const std::function<Json(int runs)>& measure) {
  CLI::App app(title);
  int threads = 0;
  std::string json;
  app.add_option("--runs", runs, "Runs of which the median is reported")->capture_default_str();
  app.add_option("--threads", threads, "Threads to use, 0 = all")->capture_default_str();
  app.add_option("--json", json, "File for the results");
  CLI11_PARSE(app, argc, argv);
  set_threads(threads);
  const Json j = measure(runs);
  std::printf("%s\n", j.dump(1).c_str());
  if (!json.empty()) std::ofstream(json) << j.dump(1) << "\n";
  return 0;
}

}  // namespace underbrush::bench
