/// \file
/// The parts that all verbs of the command line share: options, results and provenance.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "cli/help.hpp"
#include "cli/outputs.hpp"
#include "cli/program.hpp"

namespace underbrush::app {

using Json = nlohmann::ordered_json;

/// A verb, with its own options and those common to all verbs.
class Verb {
 public:
  /// Adds the common options to `app`, which is a program of its own or a verb of `program`.
  Verb(const Program& program, CLI::App& app);
  Verb(const Verb&) = delete;
  Verb& operator=(const Verb&) = delete;

  CLI::App& app;
  uint64_t seed = 1;
  int threads = 0;
  std::string json;  ///< File for the results as JSON, "-" for standard output, "" for none.

  bool force = false;  ///< Whether outputs may replace files that are not ours.

  /// Adds an option that names an output (`mark_output`).
  template <class T>
  CLI::Option* output(const std::string& name, T& place, const std::string& help,
                      const std::vector<std::string>& files = {}) {
    return mark_output(name.substr(0, name.find(',')), app.add_option(name, place, help), place,
                       files);
  }
  /// Marks an option as the name of an output. The provenance leaves it out, so that equal results
  /// are equal files wherever they are written. Before the verb runs, `check_outputs` compares all
  /// outputs with each other and with the files and folders that the other options name. `files`
  /// are those written into a folder that is not replaced as a whole.
  template <class T>
  CLI::Option* mark_output(const std::string& name, CLI::Option* option, T& place,
                           const std::vector<std::string>& files = {}) {
    const auto paths = [&place]() -> std::vector<std::filesystem::path> {
      if constexpr (std::is_constructible_v<std::filesystem::path, T>) {
        return {place};
      } else {
        return {place.begin(), place.end()};
      }
    };
    output_options_.push_back({name, paths, files});
    return not_of_result(option);
  }
  /// Marks an option that does not change the result; the provenance leaves it out.
  CLI::Option* not_of_result(CLI::Option* option);
  /// Puts the options that are added next into this group.
  void begin_group(const std::string& title) { app.option_defaults()->group(title); }
  /// Puts the options that are added next into a group that only `--help-all` shows.
  void begin_rare_group(const std::string& title = "More options");

  /// Returns the first word of the command line that is not an option: the verb's main input.
  std::string main_input() const;
  /// Throws as `check_outputs` does.
  void check_all_outputs() const;
  /// Prints the results: `table` for people on standard output (unless JSON goes there), and
  /// `results` to the destination of `--json`.
  void report(const Json& results, const std::string& table) const;
  /// Returns the provenance of an output: a JSON object with program version, command line (without
  /// options that do not change the result), seed, and a hash (XXH3, 128 bits) of every input file,
  /// including the `--config` file. Empty paths are left out.
  std::string provenance(const std::vector<std::filesystem::path>& inputs) const;

 private:
  struct OutputOption {
    std::string name;
    std::function<std::vector<std::filesystem::path>()> paths;
    std::vector<std::string> files;
  };

  std::vector<std::string> command_of_result() const;
  /// Throws `IoError` for results that cannot be written there, which names the outputs that are.
  [[noreturn]] void cannot_write(const std::string& place) const;

  const Program& program_;
  std::shared_ptr<HelpFormatter> help_;
  std::vector<const CLI::Option*> not_of_result_;
  std::vector<OutputOption> output_options_;
};

/// Adds the verb `name` to the program, listed under `stage`. `run` is called after parsing;
/// `Program::run` turns its exceptions into one line and an exit code. `example` ends the verb's
/// `--help`.
std::shared_ptr<Verb> add_verb(Program& program, const std::string& stage, const std::string& name,
                               const std::string& summary, const std::string& example,
                               const std::function<void(const Verb&)>& run);
/// Makes the program itself a verb, for programs without verbs; `example` and `run` are as for
/// `add_verb`.
std::shared_ptr<Verb> make_verb(Program& program, const std::string& example,
                                const std::function<void(const Verb&)>& run);

/// Returns `verb.provenance(inputs)`.
inline std::string provenance(const Verb& verb, const std::vector<std::filesystem::path>& inputs) {
  return verb.provenance(inputs);
}

}  // namespace underbrush::app
