#include "underbrush/optimize/checkpoint.hpp"

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::optimize {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kFormat = "underbrush-optimize";

}  // namespace

void write_checkpoint(const fs::path& path, const Checkpoint& checkpoint) {
  Json j;
  j["format"] = kFormat;
  j["version"] = 1;
  j["finished"] = checkpoint.finished;
  j["run"] = io::json_of_text(checkpoint.run);
  j["evaluations"] = Json::array();
  for (const Evaluation& e : checkpoint.evaluations) {
    Json one;
    one["value"] = e.value;
    one["objective"] = e.outcome.objective;
    for (const auto& [name, x] : e.outcome.score) one["score"][name] = x;  // NaN becomes null
    j["evaluations"].push_back(std::move(one));
  }
  io::write_atomically(path, io::text_of_json(j, 1) + "\n");
}

Checkpoint read_checkpoint(const fs::path& path) {
  const io::JsonFile json(path);
  const io::JsonValue j = json.manifest(kFormat, 1, "a checkpoint");
  Checkpoint out;
  out.finished = j.at("finished").boolean();
  out.run = j.at("run").dump();
  for (const io::JsonValue& one : j.at("evaluations").values()) {
    Evaluation e{one.at("value").numbers(), {one.at("objective").number(), {}}};
    if (const auto score = one.find("score")) {
      for (const std::string& name : score->member_names()) {
        const io::JsonValue x = score->at(name.c_str());
        e.outcome.score[name] = x.is_null() ? std::numeric_limits<double>::quiet_NaN() : x.number();
      }
    }
    out.evaluations.push_back(std::move(e));
  }
  return out;
}

}  // namespace underbrush::optimize
