#include "cli/program.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <thread>

#include "cli/config.hpp"
#include "cli/help.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/core/temporary.hpp"
#include "version.hpp"

namespace underbrush::app {
namespace {

/// Whether a signal, or the end of the work, has begun to end the process; the other one is too
/// late.
std::atomic<bool> is_ending{false};

// On SIGINT, SIGTERM or SIGHUP this removes half-written outputs and temporary files and prints one
// line. Then it lets the signal end the process, so that a shell stops its script too (it sees 128
// + the signal's number).
void clean_up_on_signals(const std::string& program) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int s : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    sigaction(s, nullptr, &now);
    // A signal that is ignored stays ignored, as under nohup.
    if (now.sa_handler != SIG_IGN) sigaddset(&signals, s);
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // Threads that start later inherit the mask.
  std::thread([signals, program] {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0 || is_ending.exchange(true)) return;
    remove_temporaries();
    std::fprintf(stderr, "%s%s: %s\n", isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "",
                 program.c_str(), signal == SIGINT ? "interrupted" : "ended by a signal");
    std::signal(signal, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    raise(signal);
  }).detach();
}

}  // namespace

std::string version() { return UNDERBRUSH_VERSION; }

Program::Program(const std::string& name, const std::string& summary) : app_(summary, name) {
  app_.set_version_flag("--version", name + " " UNDERBRUSH_VERSION);
  app_.formatter(std::make_shared<HelpFormatter>());
  app_.set_help_all_flag("--help-all", "Print all options and exit");
  app_.set_config("--config", "", "Read options from a YAML file; flags override it")
      ->type_name("FILE.yaml");
  app_.config_formatter(std::make_shared<YamlConfig>(app_));
}

void Program::check_verb() const {
  if (words_.size() < 2 || words_[1].empty() || words_[1][0] == '-') return;
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app_.get_subcommands({})) verbs.push_back(verb->get_name());
  if (verbs.empty() || std::find(verbs.begin(), verbs.end(), words_[1]) != verbs.end()) return;
  const std::string near = nearest_name(words_[1], verbs);
  throw std::invalid_argument("no verb " + in_quotes(words_[1]) +
                              (near.empty() ? "" : ": did you mean '" + near + "'?") + " (see " +
                              app_.get_name() + " --help)");
}

std::string Program::unknown_option() const {
  const auto verbs = app_.get_subcommands();
  const CLI::App& verb = verbs.empty() ? app_ : *verbs.front();
  std::vector<std::string> known;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (const std::string& word : words_) {
    const std::string name = word.substr(0, word.find('='));
    if (name == "--") break;
    const bool known_here = verb.get_option_no_throw(name) || app_.get_option_no_throw(name);
    if (!name.starts_with("--") || known_here) continue;
    const std::string near = nearest_name(name, known);
    return "no option " + in_quotes(name) + (near.empty() ? "" : ": did you mean " + near + "?");
  }
  return "";
}

int Program::parse() {
  check_verb();
  std::vector<std::string> words(words_.begin() + std::min<ptrdiff_t>(1, ssize(words_)),
                                 words_.end());
  std::reverse(words.begin(), words.end());  // CLI11 expects the words in reverse order.
  app_.parse(std::move(words));
  return 0;
}

int Program::run(int argc, char** argv) {
  const int code = outcome(argc, argv);
  while (is_ending.exchange(true)) pause();  // The signal ends the process.
  return code;
}

int Program::outcome(int argc, char** argv) {
  clean_up_on_signals(app_.get_name());
  on_remains_removed([name = app_.get_name()](const std::filesystem::path& folder, size_t count) {
    std::fprintf(stderr, "%s: removed from %s what %zu killed run%s left\n", name.c_str(),
                 printable(folder.string()).c_str(), count, count == 1 ? "" : "s");
  });
  words_.assign(argv, argv + argc);
  const auto fail = [&](const std::string& what, int code) {
    std::fprintf(stderr, "%s: %s\n", app_.get_name().c_str(), printable(what).c_str());
    return code;
  };
  try {
    return parse();
  } catch (const CLI::FileError& e) {
    const auto file = app_.get_config_ptr()->as<std::string>();
    const bool folder = std::filesystem::is_directory(file);
    return fail(file + (folder ? ": is a folder, expected a file" : ": cannot be read"), 3);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app_.exit(e);  // --help, --version
    std::string line;
    const int code = e.get_exit_code();
    const bool missing = code == int(CLI::ExitCodes::RequiredError);  // It may be misspelt.
    if (missing || code == int(CLI::ExitCodes::ExtrasError)) line = unknown_option();
    if (line.empty()) line = e.what();
    line.erase(line.find_last_not_of('\n') + 1);
    // An option without an upper bound would print the largest number, 309 digits long.
    const size_t range = line.find(" not in range ");
    if (range != std::string::npos && line.size() - range > 300) {
      line.replace(range, std::string::npos, " is too small");
    }
    const auto verbs = app_.get_subcommands();
    const std::string verb = verbs.empty() ? "" : " " + verbs.front()->get_name();
    return fail(line + " (see " + app_.get_name() + verb + " --help)", 2);
  } catch (const std::invalid_argument& e) {
    return fail(e.what(), 2);
  } catch (const FormatError& e) {
    return fail(e.what(), 3);
  } catch (const std::filesystem::filesystem_error& e) {
    return fail(e.path1().string() + ": " + e.code().message(), 4);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", 4);
  } catch (const std::exception& e) {
    return fail(e.what(), 4);
  }
}

}  // namespace underbrush::app
