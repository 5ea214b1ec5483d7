/// What all verbs of the command line share: options, progress, results and provenance.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace underbrush::app {

using Json = nlohmann::ordered_json;

/// Options common to all verbs, and what a verb reports.
struct Verb {
  CLI::App* app = nullptr;
  uint64_t seed = 1;
  int threads = 0;
  std::string
      json;  ///< Where the results go as JSON: a file, "-" for standard output, "" for none.

  /// Prints the results: `table` for people on standard output (unless JSON goes there), `results`
  /// to `--json`.
  void report(const Json& results, const std::string& table) const;
};

/// Adds a verb with the common options. `run` is called after parsing; what it throws becomes one
/// line and an exit code in `main`. `example` is shown at the end of `--help`.
std::shared_ptr<Verb> add_verb(CLI::App& root, const std::string& name, const std::string& summary,
                               const std::string& example,
                               const std::function<void(const Verb&)>& run);

/// Provenance of an output: a JSON object with program version, command line (without outputs and
/// threads, so that equal results are equal files), seed and a hash
/// (XXH3, 128 bits) of every input file, the `--config` file among them.
std::string provenance(const Verb& verb, const std::vector<std::filesystem::path>& inputs);

/// A line of progress on standard error, where that is a terminal.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  /// `done` of `total`; draws at most ten times a second.
  void operator()(size_t done, size_t total);

 private:
  std::string what_;
  bool shown_ = false, terminal_;
  double last_s_ = 0, start_s_;
};

/// The same for work in stages, one line after another.
class StageProgress {
 public:
  void operator()(std::string_view stage, size_t done, size_t total);

 private:
  std::string stage_;
  std::unique_ptr<Progress> line_;
};

/// A number for people: 12 345 678 as "12.3 M".
std::string si(double value);

}  // namespace underbrush::app
