#include "cli/verb.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/seed.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/json_text.inl"
#include "version.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

constexpr int kMostThreads = 1024;
constexpr const char* kForceGroup = "Outputs";

// Devices and pipes are written to directly; a temporary file beside them makes no sense.
bool is_device(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::is_character_file(status) || fs::is_fifo(status);
}

/// Whether a word of the command line is this option, with or without its value.
bool is_word_of(const CLI::Option& option, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const auto among = [&](const std::vector<std::string>& names, const std::string& dashes) {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& n) { return name == dashes + n; });
  };
  return among(option.get_lnames(), "--") || among(option.get_snames(), "-");
}

/// CLI11 would read -1 as the largest number of its type.
CLI::Validator whole_number() {
  return {[](std::string& word) {
            const bool digits = !word.empty() && word.find_first_not_of("0123456789") > word.size();
            return digits ? std::string() : "expected a whole number from 0 on";
          },
          ""};
}

}  // namespace

Verb::Verb(const Program& program, CLI::App& of)
    : app(of), program_(program), help_(std::make_shared<HelpFormatter>()) {
  app.formatter(help_);
  app.fallthrough();  // This passes --config on to the program, which owns it.
  begin_group(kCommonGroup);
  app.add_option("--seed", seed, kSeedHelp)->check(whole_number())->capture_default_str();
  not_of_result(app.add_option("--threads", threads, "Number of threads; 0 = all cores"))
      ->check(CLI::Range(0, kMostThreads))
      ->capture_default_str();
  not_of_result(app.add_option("--json", json,
                               "Write the results as JSON to FILE, or to standard output with -"))
      ->type_name("FILE|-")
      ->configurable(false);
  output_options_.push_back(
      {"--json", [this] { return std::vector<fs::path>{json == "-" ? "" : json}; }, {}});
  app.set_help_flag("-h,--help", "Print this help and exit")->group(kCommonGroup);
  app.set_help_all_flag("--help-all", "Print the help of all options and exit")
      ->group(kCommonGroup);
  help_->hide(kForceGroup);
  not_of_result(app.add_flag("--force", force, "Replace files that underbrush did not write"))
      ->group(kForceGroup)
      ->configurable(false);
  begin_group("Options");
}

CLI::Option* Verb::not_of_result(CLI::Option* option) {
  not_of_result_.push_back(option);
  return option;
}

void Verb::begin_rare_group(const std::string& title) {
  help_->hide(title);
  begin_group(title);
}

std::string Verb::main_input() const {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() && !option->results().empty()) return option->results().front();
  }
  return program_.app().get_name();
}

void Verb::check_all_outputs() const {
  std::vector<fs::path> inputs;
  const auto add = [&](const std::string& word) {
    std::error_code error;
    if (!word.empty() && fs::exists(word, error)) inputs.emplace_back(word);
  };
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_type_size() == 0 ||
        std::find(not_of_result_.begin(), not_of_result_.end(), option) != not_of_result_.end()) {
      continue;
    }
    for (const std::string& word : option->results()) {
      add(word);
      add(word.substr(word.find('=') + 1));  // NAME=FILE
    }
  }
  for (const std::string& word : program_.app().get_config_ptr()->results()) add(word);
  std::vector<Output> outputs;
  for (const OutputOption& option : output_options_) {
    for (const fs::path& path : option.paths()) {
      outputs.push_back({option.name, path, option.files});
    }
  }
  check_outputs(outputs, inputs, force);
}

void Verb::cannot_write(const std::string& place) const {
  std::string written;
  for (const OutputOption& option : output_options_) {
    for (const fs::path& path : option.paths()) {
      std::error_code error;
      if (path.empty() || is_device(path) || path == json || !fs::exists(path, error)) continue;
      written += (written.empty() ? "; whole are: " : ", ") + path.string();
    }
  }
  throw IoError(place + ": cannot write" + written);
}

void Verb::report(const Json& results, const std::string& table) const {
  if (json != "-" && !(std::cout << table << std::flush)) cannot_write("standard output");
  if (json.empty()) return;
  Json all = results;
  if (all.is_object() && !all.contains("program"))
    all["program"] = "underbrush " UNDERBRUSH_VERSION;
  const std::string text = io::text_of_json(all, 2) + "\n";
  if (json == "-") {
    if (!(std::cout << text << std::flush)) cannot_write("standard output");
    return;
  }
  if (is_device(json)) {
    std::ofstream out(json);
    if (!(out << text << std::flush)) cannot_write(json);
    return;
  }
  io::write_atomically(json, text);
}

std::vector<std::string> Verb::command_of_result() const {
  const std::vector<std::string>& words = program_.words();
  std::vector<std::string> out{program_.app().get_name()};
  for (size_t i = 1; i < words.size(); ++i) {
    const auto option =
        std::find_if(not_of_result_.begin(), not_of_result_.end(),
                     [&](const CLI::Option* o) { return is_word_of(*o, words[i]); });
    if (option == not_of_result_.end()) {
      out.push_back(words[i]);
    } else if ((*option)->get_expected_max() > 0 && words[i].find('=') == std::string::npos) {
      do ++i;  // Skips the option's values, too.
      while ((*option)->get_expected_max() > 1 && i + 1 < words.size() && words[i + 1][0] != '-');
    }
  }
  return out;
}

std::string Verb::provenance(const std::vector<fs::path>& inputs) const {
  Json p;
  p["program"] = "underbrush " UNDERBRUSH_VERSION;
  p["command"] = command_of_result();
  p["seed"] = seed;
  p["inputs"] = Json::object();
  for (const fs::path& input : inputs) {
    if (!input.empty()) p["inputs"][input.string()] = io::hash_of(input);
  }
  for (const std::string& file : program_.app().get_config_ptr()->results()) {
    p["inputs"][file] = io::hash_of(file);
  }
  return io::text_of_json(p);
}

namespace {

std::shared_ptr<Verb> made(const Program& program, CLI::App& app, const std::string& example,
                           const std::function<void(const Verb&)>& run) {
  auto verb = std::make_shared<Verb>(program, app);
  app.footer("Example:\n  " + example);
  app.callback([verb, run] {
    set_threads(verb->threads);
    verb->check_all_outputs();
    if (!verb->json.empty() && verb->json != "-" && !is_device(verb->json)) {
      io::check_output(verb->json);
    }
    try {
      run(*verb);
    } catch (const DataError& e) {
      throw FormatError(verb->main_input(), "", e.what());
    }
  });
  return verb;
}

}  // namespace

std::shared_ptr<Verb> add_verb(Program& program, const std::string& stage, const std::string& name,
                               const std::string& summary, const std::string& example,
                               const std::function<void(const Verb&)>& run) {
  CLI::App* app = program.app().add_subcommand(name, summary)->group(stage);
  return made(program, *app, example, run);
}

std::shared_ptr<Verb> make_verb(Program& program, const std::string& example,
                                const std::function<void(const Verb&)>& run) {
  return made(program, program.app(), example, run);
}

}  // namespace underbrush::app
