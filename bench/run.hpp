// The command line that the benchmarks of perception and of the FMU share.
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace underbrush::bench {

using Json = nlohmann::ordered_json;

/// The time of all cores that the process has had. Unlike the time of a clock it does not count the
/// work of other processes.
double cpu_seconds();

/// Reads the options, measures, and prints the results.
int run(int argc, char** argv, const std::string& title, int runs,
        const std::function<Json(int runs)>& measure);

}  // namespace underbrush::bench
