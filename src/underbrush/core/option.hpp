/// \file
/// This file has the tables of options: one for each verb, over which the command line,
/// configuration files, the reference pages and Python loop.
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace underbrush {

/// A function that gives an option's field in the options `T` of a verb.
template <class T>
using OptionField = std::variant<double& (*)(T&), int& (*)(T&), size_t& (*)(T&), bool& (*)(T&),
                                 std::string& (*)(T&), std::vector<std::string>& (*)(T&)>;

/// An option of a verb whose options are the struct `T`, in which the default stands.
template <class T>
struct Option {
  std::string_view name;   ///< The name on the command line, without dashes.
  std::string_view group;  ///< The heading under which `--help-all` has it; "" for the usual ones.
  std::string_view unit;   ///< For example "m"; empty for a pure number and for text.
  std::string_view help;
  OptionField<T> field;
  /// The limits of a number, both included.
  double least = -std::numeric_limits<double>::infinity(),
         most = std::numeric_limits<double>::infinity();
  std::vector<std::string_view> choices{};  ///< What a text may be; empty where it may be anything.
  std::string_view value{};  ///< What the help shows for a value, such as "FILE.yaml".
};

/// Returns the pointer to a captureless lambda that gives a field.
template <class T, class Get>
OptionField<T> field_of(Get get) {
  using Place = std::remove_reference_t<decltype(get(std::declval<T&>()))>;
  return static_cast<Place& (*)(T&)>(get);
}

/// The type of an option's value as Python names it: "float", "int", "bool", "str" or
/// "Sequence[str]".
template <class T>
std::string_view type_of(const Option<T>& option) {
  constexpr std::string_view kNames[] = {"float", "int", "int", "bool", "str", "Sequence[str]"};
  return kNames[option.field.index()];
}

/// Returns the value as text, such as "0.5", "true" or "once"; the words of a list are joined by
/// commas.
template <class T>
std::string text_of(const Option<T>& option, const T& options) {
  return std::visit(
      [&](const auto get) -> std::string {
        const auto& value = get(const_cast<T&>(options));  // It is only read.
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::string>) {
          return value;
        } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
          std::string all;
          for (const std::string& word : value) all += (all.empty() ? "" : ",") + word;
          return all;
        } else if constexpr (std::is_same_v<Value, bool>) {
          return value ? "true" : "false";
        } else {
          char digits[32];
          return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
        }
      },
      option.field);
}

/// Throws `std::invalid_argument` where a value of `options` is not finite, out of its limits or
/// none of its choices. `verb` begins the message.
template <class T>
void check_options(std::string_view verb, std::span<const Option<T>> table, const T& options) {
  for (const Option<T>& o : table) {
    const auto fail = [&](const std::string& why) {
      throw std::invalid_argument(std::string(verb) + ": " + std::string(o.name) + " is " + why +
                                  ", not " + text_of(o, options));
    };
    std::visit(
        [&](const auto get) {
          const auto& value = get(const_cast<T&>(options));
          using Value = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<Value, std::string>) {
            if (o.choices.empty()) return;
            if (std::find(o.choices.begin(), o.choices.end(), value) != o.choices.end()) return;
            std::string all;
            for (const std::string_view c : o.choices) {
              all += (all.empty() ? "one of " : ", ") + std::string(c);
            }
            fail(all);
          } else if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
            if (double(value) >= o.least && double(value) <= o.most) return;
            if (std::isinf(o.most)) {
              fail(o.least > 0 ? "positive" : "not negative");
            }
            char text[80];
            std::snprintf(text, sizeof text, "between %g and %g", o.least, o.most);
            fail(text);
          }
        },
        o.field);
  }
}

}  // namespace underbrush
