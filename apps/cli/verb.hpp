/// \file
/// What all verbs of the command line share: options, results and provenance.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/help.hpp"
#include "cli/program.hpp"

namespace underbrush::app {

using Json = nlohmann::ordered_json;

/// A verb: its options, those common to all verbs, and what it reports.
class Verb {
 public:
  /// Gives `app` (a program of its own, or a verb of `program`) the common options.
  Verb(const Program& program, CLI::App& app);
  Verb(const Verb&) = delete;
  Verb& operator=(const Verb&) = delete;

  CLI::App& app;
  uint64_t seed = 1;
  int threads = 0;
  std::string
      json;  ///< Where the results go as JSON: a file, "-" for standard output, "" for none.

  /// Adds an option that names an output. The provenance leaves it out, so that equal results are
  /// equal files wherever they are written.
  template <class T>
  CLI::Option* output(const std::string& name, T& place, const std::string& help) {
    return not_of_result(app.add_option(name, place, help));
  }
  /// Notes that an option does not change the result: the provenance leaves it out.
  CLI::Option* not_of_result(CLI::Option* option);
  /// The options that are added next belong to this group.
  void begin_group(const std::string& title) { app.option_defaults()->group(title); }
  /// As `begin_group`; only `--help-all` shows them.
  void begin_rare_group(const std::string& title = "More options");

  /// Prints the results: `table` for people on standard output (unless JSON goes there), `results`
  /// to `--json`.
  void report(const Json& results, const std::string& table) const;
  /// Provenance of an output: a JSON object with program version, command line (without what does
  /// not change the result), seed and a hash (XXH3, 128 bits) of every input file, the `--config`
  /// file among them.
  std::string provenance(const std::vector<std::filesystem::path>& inputs) const;

 private:
  std::vector<std::string> command_of_result() const;

  const Program& program_;
  std::shared_ptr<HelpFormatter> help_;
  std::vector<const CLI::Option*> not_of_result_;
};

/// Adds the verb `name` to the program, listed under `stage`. `run` is called after parsing; what it
/// throws becomes one line and an exit code in `Program::run`. `example` ends its `--help`.
std::shared_ptr<Verb> add_verb(Program& program, const std::string& stage, const std::string& name,
                               const std::string& summary, const std::string& example,
                               const std::function<void(const Verb&)>& run);
/// Makes the program itself a verb; likewise.
std::shared_ptr<Verb> make_verb(Program& program, const std::string& example,
                                const std::function<void(const Verb&)>& run);

/// Provenance of an output, as `Verb::provenance`.
inline std::string provenance(const Verb& verb, const std::vector<std::filesystem::path>& inputs) {
  return verb.provenance(inputs);
}

}  // namespace underbrush::app
