#include "cli/reference.hpp"

#include <fmt/format.h>

#include <vector>

#include "cli/help.hpp"

namespace underbrush::app {
namespace {

std::vector<const CLI::Option*> options_of(const CLI::App& app, const std::string& group,
                                           bool positional) {
  return app.get_options([&](const CLI::Option* o) {
    return o->nonpositional() != positional && (positional || o->get_group() == group);
  });
}

/// Escapes text for a cell of a Markdown table.
std::string cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return text;
}

std::string table(const std::string& title, const std::vector<const CLI::Option*>& options) {
  if (options.empty()) return "";
  std::string out = "\n| " + title + " | what it does |\n|---|---|\n";
  for (const CLI::Option* o : options) {
    out += fmt::format("| `{}` | {} |\n", cell(written(*o)), cell(described(*o)));
  }
  return out;
}

/// Escapes text for roff, so that no hyphen becomes a dash and no line a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) {
      out += "\\&";
      out += c;
    } else {
      out += c;
    }
  }
  return out;
}

std::string roff_options(const CLI::App& app) {
  std::string out;
  const auto add = [&](const std::vector<const CLI::Option*>& options) {
    for (const CLI::Option* o : options) {
      out += fmt::format(".TP\n.B {}\n{}\n", roff(written(*o)), roff(described(*o)));
    }
  };
  add(options_of(app, "", true));
  for (const std::string& group : app.get_groups()) {
    if (group != kCommonGroup) add(options_of(app, group, false));
  }
  return out;
}

}  // namespace

std::string command_line_page(const CLI::App& program) {
  std::string out = fmt::format(
      "# Command line\n\nThis page is made from the program's own definitions. `{0} VERB --help` "
      "shows "
      "what most people\nneed, `{0} VERB --help-all` all of it.\n\n| verb | what it does "
      "|\n|---|---|\n",
      program.get_name());
  const auto verbs = verbs_of(program);
  for (const CLI::App* v : verbs) {
    out += fmt::format("| [`{0}`](#{0}) | {1} |\n", v->get_name(), cell(v->get_description()));
  }
  out += "\n## Common options\n\nEvery verb that works on data has these.\n";
  auto common = options_of(*verbs.front(), kCommonGroup, false);
  common.push_back(program.get_config_ptr());
  out += table("option", common);
  for (const CLI::App* v : verbs) {
    out += fmt::format("\n## {}\n\n{}.\n", v->get_name(), v->get_description());
    out += table("argument", options_of(*v, "", true));
    for (const std::string& group : v->get_groups()) {
      if (group == kCommonGroup || group == kUnlistedGroup || group.empty()) continue;
      out += table(group == "Options" ? "option" : group, options_of(*v, group, false));
    }
  }
  return out;
}

std::string manual_page(const CLI::App& program, const std::string& version) {
  const std::string name = program.get_name();
  std::string out =
      fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n", roff(name), name, version);
  out += fmt::format(".SH NAME\n{} \\- a lidar simulator learnt from logs of off\\-road terrain\n",
                     name);
  out += fmt::format(".SH SYNOPSIS\n.B {}\n.I VERB\n[OPTIONS]\n", name);
  out += ".SH COMMON OPTIONS\n";
  const auto verbs = verbs_of(program);
  auto common = options_of(*verbs.front(), kCommonGroup, false);
  common.push_back(program.get_config_ptr());
  for (const CLI::Option* o : common) {
    out += fmt::format(".TP\n.B {}\n{}\n", roff(written(*o)), roff(described(*o)));
  }
  out += ".SH VERBS\n";
  for (const CLI::App* v : verbs) {
    out += fmt::format(".SS {}\n{}.\n{}", roff(v->get_name()), roff(v->get_description()),
                       roff_options(*v));
    out += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(v->get_footer()));
  }
  return out +
         ".SH EXIT STATUS\n0 done, 2 wrong usage, 3 bad input, 4 failure while running, 128 + N "
         "ended "
         "by signal N.\n";
}

}  // namespace underbrush::app
