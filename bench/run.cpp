#include "run.hpp"

#include <time.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::bench {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

int run(int argc, char** argv, const std::string& title, int runs,
        const std::function<Json(int runs)>& measure) {
  CommandLine line(title);
  int threads = 0;
  line.add("--runs", &runs, "Runs of which the median is reported");
  line.add("--threads", &threads, "Threads to use, 0 = all");
  line.add_json();
  if (const auto end = line.parse(argc, argv)) return *end;
  set_threads(threads);
  const Json j = measure(runs);
  std::printf("%s\n", j.dump(1).c_str());
  line.write(j);
  return 0;
}

}  // namespace underbrush::bench
