#include "underbrush/optimize/checkpoint.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/file.hpp"

namespace underbrush::optimize {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kFormat = "underbrush-optimize";
constexpr uint64_t kLargest = 1 << 28;

double number_of(const Json& j) {
  return j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
}

}  // namespace

void write_checkpoint(const fs::path& path, const Checkpoint& checkpoint) {
  Json j;
  j["format"] = kFormat;
  j["version"] = 1;
  j["finished"] = checkpoint.finished;
  j["run"] = Json::parse(checkpoint.run);
  j["evaluations"] = Json::array();
  for (const Evaluation& e : checkpoint.evaluations) {
    Json one;
    one["value"] = e.value;
    one["objective"] = e.outcome.objective;
    for (const auto& [name, x] : e.outcome.score) one["score"][name] = x;  // NaN becomes null
    j["evaluations"].push_back(std::move(one));
  }
  io::write_atomically(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << j.dump(1) << "\n";
    if (!out.flush()) throw IoError(path.string() + ": cannot write");
  });
}

Checkpoint read_checkpoint(const fs::path& path) {
  const std::string text = io::read_file(path, kLargest);
  Checkpoint out;
  try {
    const Json j = Json::parse(text);
    if (j.value("format", "") != kFormat) throw FormatError(path.string(), "", "not a checkpoint");
    if (j.at("version") != 1) throw FormatError(path.string(), "version", "only 1 can be read");
    out.finished = j.at("finished");
    out.run = j.at("run").dump();
    for (const Json& one : j.at("evaluations")) {
      Evaluation e{one.at("value").get<std::vector<double>>(), {one.at("objective"), {}}};
      if (!std::isfinite(e.outcome.objective)) {
        throw FormatError(path.string(), "evaluations", "an objective is not finite");
      }
      if (one.contains("score")) {
        for (const auto& [name, x] : one["score"].items()) e.outcome.score[name] = number_of(x);
      }
      out.evaluations.push_back(std::move(e));
    }
  } catch (const nlohmann::json::exception& e) {
    throw FormatError(path.string(), "", e.what());
  }
  return out;
}

}  // namespace underbrush::optimize
