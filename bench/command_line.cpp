#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

namespace underbrush::bench {

struct CommandLine::Parser {
  CLI::App app;
};

CommandLine::CommandLine(const std::string& title) : parser_(new Parser{CLI::App(title)}) {}
CommandLine::~CommandLine() = default;

void CommandLine::add(const std::string& name, Value value, const std::string& help,
                      const std::vector<std::string>& choices) {
  CLI::App& app = parser_->app;
  if (const auto flag = std::get_if<bool*>(&value)) {
    app.add_flag(name, **flag, help);
    return;
  }
  CLI::Option* option = std::visit(
      [&](auto* to) -> CLI::Option* {
        if constexpr (std::is_same_v<decltype(to), bool*>) {
          return nullptr;
        } else {
          return app.add_option(name, *to, help)->capture_default_str();
        }
      },
      value);
  if (!choices.empty()) option->check(CLI::IsMember(choices));
}

void CommandLine::add_json() {
  add("--json", &json_file_, "Write the figures to this file as JSON");
}

std::optional<int> CommandLine::parse(int argc, char** argv) {
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return parser_->app.exit(e);
  }
  return {};
}

void CommandLine::write(const nlohmann::ordered_json& figures) const {
  if (!json_file_.empty()) std::ofstream(json_file_) << figures.dump(1) << "\n";
}

}  // namespace underbrush::bench
