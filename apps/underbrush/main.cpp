#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/temporary.hpp"
#include "verbs.hpp"
#include "version.hpp"
#include "yaml_config.hpp"

namespace {

// On Ctrl-C and its like: no half-written output and no temporary file stays, one line, and then
// the signal's own end, so that a shell stops its script too (it sees 128 + the signal's number).
void clean_up_on_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int s : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    sigaction(s, nullptr, &now);
    if (now.sa_handler != SIG_IGN) sigaddset(&signals, s);  // nohup stays as it is
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // for all threads to come
  std::thread([signals] {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    underbrush::remove_temporaries();
    std::fprintf(stderr, "%sunderbrush: %s\n", isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "",
                 signal == SIGINT ? "interrupted" : "ended by a signal");
    std::signal(signal, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    raise(signal);
  }).detach();
}

}  // namespace

// Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 failure while running;
// ended by a signal, 128 + its number.
int main(int argc, char** argv) {
  using namespace underbrush;
  clean_up_on_signals();
  app::remember_command_line(argc, argv);
  CLI::App root("Underbrush: a lidar simulator learnt from logs of off-road terrain.",
                "underbrush");
  root.set_version_flag("--version", "underbrush " UNDERBRUSH_VERSION);
  root.require_subcommand(1);
  app::add_all_verbs(root);
  app::add_config(root);
  const auto fail = [](const char* what, int code) {
    std::fprintf(stderr, "underbrush: %s\n", what);
    return code;
  };
  try {
    std::vector<std::string> words = app::with_config(root, argc, argv);
    std::reverse(words.begin(), words.end());  // as CLI11 wants them
    root.parse(std::move(words));
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return root.exit(e);  // --help, --version
    std::string line = e.what();
    line.erase(line.find_last_not_of('\n') + 1);
    const auto verbs = root.get_subcommands();
    const std::string verb = verbs.empty() ? "" : " " + verbs.front()->get_name();
    return fail((line + " (see underbrush" + verb + " --help)").c_str(), 2);
  } catch (const std::invalid_argument& e) {
    return fail(e.what(), 2);
  } catch (const FormatError& e) {
    return fail(e.what(), 3);
  } catch (const std::filesystem::filesystem_error& e) {
    return fail((e.path1().string() + ": " + e.code().message()).c_str(), 4);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", 4);
  } catch (const std::exception& e) {
    return fail(e.what(), 4);
  }
}
