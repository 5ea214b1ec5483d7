#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <new>
#include <string>
#include <vector>

#include "underbrush/core/check.hpp"
#include "verbs.hpp"
#include "version.hpp"
#include "yaml_config.hpp"

// Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 failure while running.
int main(int argc, char** argv) {
  using namespace underbrush;
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
  } catch (const std::bad_alloc&) {
    return fail("out of memory", 4);
  } catch (const std::exception& e) {
    return fail(e.what(), 4);
  }
}
