#include "cli/dump_config.hpp"

#include <iostream>
#include <memory>
#include <string>

namespace underbrush::app {

void add_dump_config(Program& program) {
  CLI::App* verb = program.app().add_subcommand(
      "dump-config", "Print the options of a verb with their defaults, as a file for --config");
  verb->group("Help");
  auto name = std::make_shared<std::string>();
  verb->add_option("VERB", *name, "The verb whose options are printed")->required();
  verb->footer("Example:\n  underbrush dump-config fit > fit.yaml");
  verb->callback([&program, name] {
    for (const CLI::App* other : program.app().get_subcommands({})) {
      if (other->get_name() == *name) {
        std::cout << program.app().get_config_formatter()->to_config(other, true, true, "");
        return;
      }
    }
    throw std::invalid_argument("dump-config: no verb '" + *name + "'");
  });
}

}  // namespace underbrush::app
