#include "underbrush/jobs/merge_plan.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/log_file.hpp"
#include "underbrush/jobs/joined_logs.hpp"
#include "underbrush/jobs/record.hpp"

namespace underbrush::jobs {
namespace fs = std::filesystem;
namespace {

/// The provenance of a piece without the option that cut it, which is that of the whole command.
std::string provenance_of_whole(const fs::path& piece) {
  const std::string text = io::LogReader(piece).provenance();
  const auto json = io::json_if_valid(text);
  if (!json || !json->is_object() || !json->contains("command") ||
      !json->at("command").is_array()) {
    throw FormatError(piece.string(), "", "has no provenance of its command");
  }
  nlohmann::ordered_json whole = *json, words = nlohmann::ordered_json::array();
  for (const auto& word : json->at("command")) {
    if (!word.is_string() || !word.get<std::string>().starts_with("--beams="))
      words.push_back(word);
  }
  whole["command"] = words;
  return io::text_of_json(whole);
}

void copy(const fs::path& from, const std::string& to) {
  const auto kind = fs::is_directory(from) ? io::OutputKind::kFolder : io::OutputKind::kFile;
  io::write_atomically(
      fs::path(to + "/.").lexically_normal().parent_path(),
      [&](const fs::path& temporary) { fs::copy(from, temporary, fs::copy_options::recursive); },
      kind);
}

}  // namespace

void merge_plan(const fs::path& folder, const Plan& plan) {
  const TemporaryPath cleans(folder, "merge");  // Removes what killed tasks have left.
  std::vector<Record> records;
  for (size_t k = 0; k < plan.tasks.size(); ++k) {
    const std::optional<Record> record = checked_record(folder, plan, k);
    if (!record) {
      const bool failed = read_failure(folder, k).has_value();
      throw FormatError(folder.string(), "task " + std::to_string(k),
                        failed ? "failed: plan --status has its last lines" : "was not run");
    }
    records.push_back(*record);
  }
  for (size_t k = 0; k < plan.tasks.size(); ++k) {
    for (size_t e = 0; e < records[k].earlier.size(); ++e) {
      const EarlierOutput& from = plan.tasks[k].earlier[e];
      if (records[k].earlier[e] == records[from.task].outputs[from.output].hash) continue;
      throw FormatError(folder.string(), "task " + std::to_string(k),
                        "was made from another output of task " + std::to_string(from.task));
    }
  }
  for (const Result& result : plan.results) {
    std::vector<fs::path> files;
    for (const size_t task : result.tasks) {
      files.push_back(folder / records[task].outputs[result.output].path);
    }
    if (result.first_chunk == 0) {
      copy(files[0], result.path);
    } else {
      JoinedLogs logs(files, result.first_chunk);
      io::export_log(result.path, logs, "", provenance_of_whole(files[0]));
    }
  }
}

}  // namespace underbrush::jobs
