/// \file
/// The options of a verb's table (`Option`) on the command line.
#pragma once
#include <string>

#include "cli/verb.hpp"
#include "underbrush/core/option.hpp"

namespace underbrush::app {

/// Checks a number against the limits of its option; other words are left to the conversion. CLI11
/// takes a negative number for a large one where the field has no sign.
template <class T>
CLI::Validator within_limits(Option<T> row, bool is_unsigned = false) {
  if (is_unsigned) row.least = std::max(row.least, 0.0);
  return {[row](std::string& word) -> std::string {
            double number = 0;
            const bool fits = !CLI::detail::lexical_cast(word, number) ||
                              (number >= row.least && number <= row.most);
            return fits ? "" : "expected a value that is " + limits_of(row);
          },
          ""};
}

/// Adds an option of the command line for a row of the table.
template <class T>
CLI::Option* add_option(CLI::App& app, const Option<T>& row, T& options) {
  const std::string name = "--" + std::string(row.name);
  std::string help(row.help);
  if (!row.unit.empty()) {  // "Rain rate, mm/h", "Maximum range, m; 0 = the log's"
    help.insert(std::min(help.find(';'), help.size()), ", " + std::string(row.unit));
  }
  CLI::Option* added = std::visit(
      [&](const auto field) -> CLI::Option* {
        auto& place = field(options);
        using Value = std::decay_t<decltype(place)>;
        if constexpr (std::is_same_v<Value, bool>) {
          return app.add_flag(name, place, help);
        } else {
          CLI::Option* option = app.add_option(name, place, help);
          if constexpr (std::is_arithmetic_v<Value>) {
            option->check(within_limits(row, std::is_unsigned_v<Value>));
            return is_outside(row, options) ? option : option->capture_default_str();
          } else {
            if (!row.choices.empty()) {
              option->check(
                  CLI::IsMember(std::vector<std::string>(row.choices.begin(), row.choices.end())));
            }
            if (row.count > 0) option->expected(row.count);
            if constexpr (std::is_same_v<Value, std::vector<double>>) {
              option->check(within_limits(row));
            }
            if constexpr (std::is_same_v<Value, std::vector<std::string>>) option->take_all();
            return place.empty() ? option : option->capture_default_str();
          }
        }
      },
      row.field);
  if (!row.value.empty()) added->type_name(std::string(row.value));
  return added;
}

/// Adds an option for every row of the table: those without a group to `Options`, the others to the
/// groups of their own, of which `--help-all` alone shows all but `shown`. The groups `left_out`
/// are not added.
template <class T>
void add_options(Verb& verb, std::span<const Option<T>> table, T& options,
                 std::string_view shown = "",
                 std::initializer_list<std::string_view> left_out = {}) {
  std::string_view group;
  verb.begin_group("Options");
  for (const Option<T>& row : table) {
    if (std::count(left_out.begin(), left_out.end(), row.group) > 0) continue;
    if (row.group != group) {
      group = row.group;
      if (group.empty()) {
        verb.begin_group("Options");
      } else if (group == shown) {
        verb.begin_group(std::string(group));
      } else {
        verb.begin_rare_group(std::string(group));
      }
    }
    add_option(verb.app, row, options);
  }
  verb.begin_group("Options");
}

}  // namespace underbrush::app
