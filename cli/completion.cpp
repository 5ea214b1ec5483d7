#include "cli/completion.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <vector>

#include "cli/help.hpp"
#include "cli/program.hpp"

namespace underbrush::app {
namespace {

/// Returns the options of a verb and those of the program that the verb accepts too.
std::vector<const CLI::Option*> options_of(const CLI::App& program, const CLI::App& verb) {
  auto options = verb.get_options(
      [](const CLI::Option* o) { return o->nonpositional() && o->get_group() != kUnlistedGroup; });
  if (&verb != &program) options.push_back(program.get_config_ptr());
  return options;
}

std::vector<std::string> spellings(const CLI::Option& option) {
  std::vector<std::string> out;
  for (const std::string& s : option.get_snames()) out.push_back("-" + s);
  for (const std::string& l : option.get_lnames()) out.push_back("--" + l);
  return out;
}

/// Returns the choices of the first positional, such as the shells of `completion`.
std::vector<std::string> positional_choices(const CLI::App& verb) {
  for (const CLI::Option* o : verb.get_options()) {
    if (!o->nonpositional()) return choices_of(*o);
  }
  return {};
}

/// Returns what the value of an option is completed to; nothing where it is a file.
std::vector<std::string> values_of(const CLI::Option& option, const Suggestions& suggestions) {
  for (const std::string& name : option.get_lnames()) {
    if (const auto found = suggestions.find(name); found != suggestions.end()) return found->second;
  }
  return choices_of(option);
}

/// Puts text into single quotes for a shell.
std::string in_quotes(std::string text) {
  for (size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 4) {
    text.replace(at, 1, "'\\''");
  }
  return "'" + text + "'";
}

std::string bash_case(const CLI::App& program, const CLI::App& verb,
                      const Suggestions& suggestions) {
  std::string words, choices;
  for (const CLI::Option* o : options_of(program, verb)) {
    const auto names = spellings(*o);
    words += fmt::format("{} ", fmt::join(names, " "));
    const auto values = values_of(*o, suggestions);
    if (!values.empty()) {
      choices += fmt::format("        {}) words={} ;;\n", fmt::join(names, "|"),
                             in_quotes(fmt::format("{}", fmt::join(values, " "))));
    } else if (o->get_expected_max() > 0) {
      choices += fmt::format("        {}) words='' ;;\n", fmt::join(names, "|"));
    }
  }
  const auto first = positional_choices(verb);
  return fmt::format(
      "    {})\n      case $previous in\n{}        *) case $current in -*) words={} ;; *) words={} "
      ";; "
      "esac ;;\n      esac ;;\n",
      verb.get_name(), choices, in_quotes(words),
      in_quotes(fmt::format("{}", fmt::join(first, " "))));
}

std::string bash_script(const CLI::App& program, const Suggestions& suggestions) {
  const std::string name = program.get_name();
  std::string cases, verbs;
  for (const CLI::App* verb : verbs_of(program)) {
    verbs += verb->get_name() + " ";
    cases += bash_case(program, *verb, suggestions);
  }
  return fmt::format(R"(# bash completion of {0}:  source <({0} completion bash)
_{0}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} words=''
  # Bash takes --option=value for three words.
  if [ "$current" = '=' ]; then
    current=''
  elif [ "$previous" = '=' ]; then
    previous=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W {1} -- "$current"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{2}  esac
  if [ -n "$words" ]; then
    COMPREPLY=($(compgen -W "$words" -- "$current"))
  fi
  if [ "${{#COMPREPLY[@]}}" -eq 0 ]; then
    compopt -o filenames 2> /dev/null
    local IFS=$'\n'
    COMPREPLY=($(compgen -f -- "$current"))
  fi
}}
complete -F _{0} {0}
)",
                     name, in_quotes(verbs + "--help --help-all --version --config"), cases);
}

/// Writes an option for zsh's _arguments: '(-o --output)'{-o,--output}'[help]:VALUE:action'.
std::string zsh_option(const CLI::Option& option, const Suggestions& suggestions) {
  std::string help;
  for (const char c : option.get_description()) {
    if (c == '[' || c == ']' || c == ':') help += '\\';
    help += c;
  }
  const auto values = values_of(option, suggestions);
  std::string value;
  if (option.get_expected_max() > 0) {
    value = values.empty() ? ":file:_files" : fmt::format(":value:({})", fmt::join(values, " "));
  }
  std::string out;
  for (const std::string& name : spellings(option)) {
    out += fmt::format("        {} \\\n", in_quotes(fmt::format("*{}[{}]{}", name, help, value)));
  }
  return out;
}

std::string zsh_script(const CLI::App& program, const Suggestions& suggestions) {
  const std::string name = program.get_name();
  std::string verbs, cases;
  for (const CLI::App* verb : verbs_of(program)) {
    verbs += fmt::format("    {}\n", in_quotes(verb->get_name() + ":" + verb->get_description()));
    std::string options;
    for (const CLI::Option* o : options_of(program, *verb)) options += zsh_option(*o, suggestions);
    const auto first = positional_choices(*verb);
    const std::string positional =
        first.empty() ? "_files" : fmt::format("({})", fmt::join(first, " "));
    cases += fmt::format("    {})\n      _arguments \\\n{}        {} ;;\n", verb->get_name(),
                         options, in_quotes("*:file:" + positional));
  }
  return fmt::format(R"(#compdef {0}
# zsh completion of {0}: a file _{0} in a folder of $fpath, or  source <({0} completion zsh)
_{0}() {{
  local -a verbs
  verbs=(
{1}  )
  if (( CURRENT == 2 )); then
    _describe verb verbs
    return
  fi
  local verb=$words[2]
  shift words
  (( CURRENT-- ))
  case $verb in
{2}  esac
}}
if [ "$funcstack[1]" = "_{0}" ]; then _{0} "$@"; else compdef _{0} {0}; fi
)",
                     name, verbs, cases);
}

std::string fish_script(const CLI::App& program, const Suggestions& suggestions) {
  const std::string name = program.get_name();
  std::string out = fmt::format(
      "# fish completion of {0}:  {0} completion fish | source\ncomplete -c {0} -e\n", name);
  for (const CLI::App* verb : verbs_of(program)) {
    out += fmt::format("complete -c {} -n __fish_use_subcommand -f -a {} -d {}\n", name,
                       verb->get_name(), in_quotes(verb->get_description()));
    const std::string condition = in_quotes("__fish_seen_subcommand_from " + verb->get_name());
    const auto first = positional_choices(*verb);
    if (!first.empty()) {
      out += fmt::format("complete -c {} -n {} -f -a {}\n", name, condition,
                         in_quotes(fmt::format("{}", fmt::join(first, " "))));
    }
    for (const CLI::Option* o : options_of(program, *verb)) {
      std::string line = fmt::format("complete -c {} -n {}", name, condition);
      for (const std::string& s : o->get_snames()) line += " -s " + s;
      for (const std::string& l : o->get_lnames()) line += " -l " + l;
      const auto values = values_of(*o, suggestions);
      if (!values.empty()) {
        line += " -x -a " + in_quotes(fmt::format("{}", fmt::join(values, " ")));
      } else if (o->get_expected_max() > 0) {
        line += " -r";
      }
      out += line + " -d " + in_quotes(o->get_description()) + "\n";
    }
  }
  return out;
}

}  // namespace

std::string completion_script(const CLI::App& program, const std::string& shell,
                              const Suggestions& suggestions) {
  if (shell == "bash") return bash_script(program, suggestions);
  if (shell == "zsh") return zsh_script(program, suggestions);
  if (shell == "fish") return fish_script(program, suggestions);
  throw std::invalid_argument("completion: no shell '" + shell + "'; there are: bash, zsh, fish");
}

void add_completion(Program& program, const Suggestions& suggestions) {
  CLI::App* verb = program.app().add_subcommand(
      "completion", "Print a script that completes verbs, options and values in a shell");
  verb->group("Help");
  auto shell = std::make_shared<std::string>();
  verb->add_option("SHELL", *shell, "The shell to complete for")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  verb->footer(
      "Example:\n  underbrush completion bash > ~/.local/share/bash-completion/completions/"
      "underbrush\n  source <(underbrush completion bash)");
  verb->callback([&program, shell, suggestions] {
    std::cout << completion_script(program.app(), *shell, suggestions);
  });
}

}  // namespace underbrush::app
