/// \file
/// The type of a row in a verb's table of options. The command line, configuration files, the
/// reference pages, Python and `serve` read these tables.
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
  using Options = T;
  std::string_view name;   ///< The name on the command line, without dashes.
  std::string_view group;  ///< The heading of the option in `--help-all`; "" for the usual ones.
  std::string_view unit;   ///< For example "m"; empty for a pure number and for text.
  std::string_view help;
  OptionField<T> field;
  /// The limits of a number, both included. A default outside of them, such as NaN, means that the
  /// option is not given.
  double least = -kNoLimit, most = kNoLimit;
  std::vector<std::string_view> choices{};  ///< The allowed texts; empty where any is allowed.
  std::string_view value{};  ///< The placeholder of a value in the help, such as "FILE.yaml".
  int count = 0;             ///< The length of a list of numbers; 0 = any.
};

/// The type of an option's value as Python names it: "float", "int", "bool", "str",
/// "Sequence[str]", "Sequence[float]", or "str | os.PathLike[str]" for a file or folder by its
/// `value`.
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
/// The overload for a flag.
inline std::string text_of(bool value) { return value ? "true" : "false"; }
/// The overload for a number.
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

/// Whether the option's value in `options` is a number outside of its limits, or a list with one.
template <class T>
bool is_outside(const Option<T>& option, const T& options) {
  const auto outside = [&](double x) { return !(x >= option.least && x <= option.most); };
  return std::visit(
      [&](const auto get) {
        const auto& value = get(const_cast<T&>(options));
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::vector<double>>) {
          return std::any_of(value.begin(), value.end(), outside);
        } else if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
          return outside(double(value));
        } else {
          return false;
        }
      },
      option.field);
}

/// Returns the value as a number, 0 or 1 for a flag. Throws `std::invalid_argument` for text.
template <class T>
double number_of(const Option<T>& option, const T& options) {
  return std::visit(
      [&](const auto get) -> double {
        const auto& value = get(const_cast<T&>(options));
        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
          return double(value);
        } else {
          throw std::invalid_argument(std::string(option.name) + " is not a number");
        }
      },
      option.field);
}

/// Sets the value from a number, which is truncated where the field is whole. Throws
/// `std::invalid_argument` for text.
template <class T>
void set_number(const Option<T>& option, T& options, double number) {
  std::visit(
      [&](const auto get) {
        auto& place = get(options);
        using Value = std::decay_t<decltype(place)>;
        if constexpr (std::is_arithmetic_v<Value>) {
          place = Value(number);
        } else {
          throw std::invalid_argument(std::string(option.name) + " is not a number");
        }
      },
      option.field);
}

/// Returns the limits of an option in words, such as "positive" or "between 0 and 1".
template <class T>
std::string limits_of(const Option<T>& option) {
  char text[80];
  if (option.most == kNoLimit) {
    if (option.least == kPositive) return "positive";
    if (option.least == 0) return "not negative";
    if (option.least == -kNoLimit) return "a number";
    std::snprintf(text, sizeof text, "at least %g", option.least);
  } else if (option.least == kPositive) {
    std::snprintf(text, sizeof text, "positive and at most %g", option.most);
  } else {
    std::snprintf(text, sizeof text, "between %g and %g", option.least, option.most);
  }
  return text;
}

/// Returns "" for a value within its limits and among its choices, and a description of the right
/// values otherwise.
template <class T>
std::string wrong_value(const Option<T>& option, const T& options) {
  if (is_outside(option, options)) return limits_of(option);
  const auto& choices = option.choices;
  if (choices.empty() ||
      std::find(choices.begin(), choices.end(), text_of(option, options)) != choices.end()) {
    return "";
  }
  std::string all;
  for (const std::string_view c : choices) all += (all.empty() ? "one of " : ", ") + std::string(c);
  return all;
}

/// Throws `std::invalid_argument` where a value of `options` is not finite, out of its limits or
/// none of its choices, unless it is the default. The rows of the table are options of `T`. `verb`
/// begins the message.
template <class Row, class T>
void check_options(std::string_view verb, std::span<const Row> table, const T& options) {
  const T defaults{};
  for (const Row& row : table) {
    const std::string right = wrong_value(row, options), value = text_of(row, options);
    if (right.empty() || value == text_of(row, defaults)) continue;
    std::string message(verb);
    for (const std::string_view part :
         {std::string_view(": "), row.name, std::string_view(" is "), std::string_view(right),
          std::string_view(", not "), std::string_view(value)}) {
      message += part;
    }
    throw std::invalid_argument(message);
  }
}

}  // namespace underbrush
