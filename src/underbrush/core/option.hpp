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

/// A function that gives an option's field in the options `T` of a verb, of one of these types.
template <class T>
struct OptionField : std::variant<double& (*)(T&), int& (*)(T&), unsigned& (*)(T&), size_t& (*)(T&),
                                  bool& (*)(T&), std::string& (*)(T&),
                                  std::vector<std::string>& (*)(T&), std::vector<double>& (*)(T&)> {
  /// Takes the field from a lambda that captures nothing, as tables have them.
  template <class Get>
  OptionField(Get get)  // NOLINT(google-explicit-constructor)
      : OptionField::variant(static_cast<decltype(get(std::declval<T&>())) (*)(T&)>(get)) {}
};

/// The least positive limit of an option.
inline constexpr double kPositive = std::numeric_limits<double>::min();
/// The limits of an option that has none.
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// An option of a verb whose options are the struct `T`, in which the default stands.
template <class T>
struct Option {
  std::string_view name;   ///< The name on the command line, without dashes.
  std::string_view group;  ///< The heading under which `--help-all` has it; "" for the usual ones.
  std::string_view unit;   ///< For example "m"; empty for a pure number and for text.
  std::string_view help;
  OptionField<T> field;
  /// The limits of a number, both included. A default outside of them, such as NaN, means that the
  /// option is not given.
  double least = -kNoLimit, most = kNoLimit;
  std::vector<std::string_view> choices{};  ///< What a text may be; empty where it may be anything.
  std::string_view value{};  ///< What the help shows for a value, such as "FILE.yaml".
  int count = 0;             ///< How many numbers a list of numbers has; 0 = any.
};

/// The type of an option's value as Python names it: "float", "int", "bool", "str",
/// "Sequence[str]", "Sequence[float]", or "str | os.PathLike[str]" for a file or folder, whose
/// `value` says so.
template <class T>
std::string_view type_of(const Option<T>& option) {
  const bool is_text = std::holds_alternative<std::string& (*)(T&)>(option.field);
  for (const std::string_view file : {"FILE", "FOLDER", ".yaml"}) {
    if (is_text && option.value.find(file) != std::string_view::npos) {
      return "str | os.PathLike[str]";
    }
  }
  constexpr std::string_view kNames[] = {"float", "int", "int",           "int",
                                         "bool",  "str", "Sequence[str]", "Sequence[float]"};
  return kNames[option.field.index()];
}

/// Returns the value as text, such as "0.5", "true" or "once".
inline std::string text_of(const std::string& value) { return value; }
/// The same of a flag.
inline std::string text_of(bool value) { return value ? "true" : "false"; }
/// The same of a number.
template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
std::string text_of(Number value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}
/// The values of a list are joined by commas.
template <class Value>
std::string text_of(const std::vector<Value>& values) {
  std::string all;
  for (const Value& value : values) all += (all.empty() ? "" : ",") + text_of(value);
  return all;
}

/// Returns the option's value in `options` as text.
template <class T>
std::string text_of(const Option<T>& option, const T& options) {
  return std::visit(
      [&](const auto get) { return text_of(get(const_cast<T&>(options))); },  // It is only read.
      option.field);
}

/// Whether the option's value in `options` is a number outside of its limits.
template <class T>
bool is_outside(const Option<T>& option, const T& options) {
  return std::visit(
      [&](const auto get) {
        const auto& value = get(const_cast<T&>(options));
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
          return !(double(value) >= option.least && double(value) <= option.most);
        } else {
          return false;
        }
      },
      option.field);
}

/// Throws `std::invalid_argument` where a value of `options` is not finite, out of its limits or
/// none of its choices, unless it is the default. `verb` begins the message.
template <class T>
void check_options(std::string_view verb, std::span<const Option<T>> table, const T& options) {
  const T defaults{};
  for (const Option<T>& o : table) {
    const std::string value = text_of(o, options);
    if (value == text_of(o, defaults)) continue;
    std::string right;
    if (!o.choices.empty() &&
        std::find(o.choices.begin(), o.choices.end(), value) == o.choices.end()) {
      for (const std::string_view c : o.choices) {
        right += (right.empty() ? "one of " : ", ") + std::string(c);
      }
    } else if (is_outside(o, options)) {
      char between[80];
      std::snprintf(between, sizeof between, "between %g and %g", o.least, o.most);
      right = !std::isinf(o.most) ? between : o.least > 0 ? "positive" : "not negative";
    }
    if (right.empty()) continue;
    throw std::invalid_argument(std::string(verb) + ": " + std::string(o.name) + " is " + right +
                                ", not " + value);
  }
}

}  // namespace underbrush
