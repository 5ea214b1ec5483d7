/// \file
/// A program with a command line: it parses options, reports errors in one line and returns the
/// exit code.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace underbrush::app {

/// Returns the version of the program, such as "0.1.0".
std::string version();

/// A program with its options or verbs.
class Program {
 public:
  Program(const std::string& name, const std::string& summary);

  CLI::App& app() { return app_; }
  const CLI::App& app() const { return app_; }
  /// Returns the words of the command line; the first is the program's name.
  const std::vector<std::string>& words() const { return words_; }

  /// Parses the command line and runs the verb that it names, once in a process. Exit codes: 0
  /// success, 2 wrong usage, 3 bad input, 4 failure while running. A signal ends the process
  /// itself, so that a shell sees 128 + its number.
  int run(int argc, char** argv);

 private:
  int outcome(int argc, char** argv);
  int parse();
  /// Throws `std::invalid_argument` where the first word is no verb.
  void check_verb() const;
  /// Returns the error on the first option that the verb does not have; "" if it has all.
  std::string unknown_option() const;

  CLI::App app_;
  std::vector<std::string> words_;
};

}  // namespace underbrush::app
