// Bytes and processor time of the formats of logs, on one thread.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "programs.hpp"
#include "site.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::bench {
namespace {
namespace fs = std::filesystem;

constexpr double kRowBytes = 63;  // in memory, without extra columns

template <class F>
double processor_seconds_of(F f) {
  const std::clock_t start = std::clock();
  f();
  return double(std::clock() - start) / CLOCKS_PER_SEC;
}

nlohmann::ordered_json measured(const BeamLog& log, const fs::path& file, int runs) {
  std::vector<double> write_s, read_s;
  size_t rows = 0;
  for (int k = 0; k < runs; ++k) {
    fs::remove(file);
    write_s.push_back(processor_seconds_of([&] { io::write_log(file, log, "{}"); }));
    read_s.push_back(processor_seconds_of([&] {
      io::LogReader reader(file);
      rows = 0;
      for (BeamLog chunk; reader.next(chunk);) rows += chunk.size();
    }));
  }
  const auto rate = [&](const std::vector<double>& s) {
    return 1e-6 * kRowBytes * double(rows) / *std::min_element(s.begin(), s.end());
  };
  return {{"beams", rows},
          {"bytes_a_beam", double(fs::file_size(file)) / double(rows)},
          {"write_mb_per_s", rate(write_s)},
          {"read_mb_per_s", rate(read_s)}};
}

}  // namespace

int bench_log_formats(int argc, char** argv) {
  CommandLine line("Bytes and speed of ray clouds and compact logs, a core");
  std::vector<std::string> logs;
  int runs = 3;
  line.add("LOGS", &logs, "Logs; default: a generated site, scanned by an HDL-64E");
  line.add_json();
  line.add("--runs", &runs, "Number of runs, of which the fastest counts");
  if (const auto end = line.parse(argc, argv)) return *end;

  set_threads(1);
  const TemporaryPath place("", "formats");
  fs::create_directory(place.path());
  nlohmann::ordered_json j;
  const auto measure = [&](const std::string& name, const BeamLog& log) {
    for (const char* ending : {"ply", "ublog"}) {
      const auto m = measured(log, place.path() / (std::string("log.") + ending), runs);
      std::printf("%-40s %-6s %s\n", name.c_str(), ending, m.dump().c_str());
      j[name][ending] = m;
    }
  };
  if (logs.empty()) measure("generated site", scanned_site(1));
  for (const std::string& log : logs) measure(log, io::read_log(log));
  line.write(j);
  return 0;
}

}  // namespace underbrush::bench
