/// \file
/// The options of a verb's table (`Option`) as Python gives them.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <string>
#include <vector>

#include "underbrush/core/names.hpp"
#include "underbrush/core/option.hpp"

namespace underbrush::python {
namespace nb = nanobind;
using namespace nb::literals;

/// Returns the rows of a table: name, type, default, unit, help.
template <class Row>
nb::list rows_of(std::span<const Row> table) {
  nb::list out;
  const typename Row::Options defaults{};
  const auto text = [](std::string_view s) { return nb::str(s.data(), s.size()); };
  for (const Row& o : table) {
    const std::string value = is_outside(o, defaults) ? "" : text_of(o, defaults);
    out.append(nb::make_tuple(text(o.name), text(type_of(o)), value, text(o.unit), text(o.help)));
  }
  return out;
}

/// Whether a table has an option with the name `key`, in which `_` stands for `-`.
template <class Row>
bool has_option(std::span<const Row> table, std::string key) {
  std::replace(key.begin(), key.end(), '_', '-');
  return std::any_of(table.begin(), table.end(), [&](const Row& o) { return o.name == key; });
}

/// Sets the option with the name `key`, in which `_` stands for `-`. Throws a Python `TypeError`
/// for an unknown name, which it compares with the known ones, and for a value of the wrong type.
template <class Row, class T>
void set_option(std::string_view verb, std::span<const Row> table, T& options,
                const std::string& key, nb::handle value) {
  std::string name = key;
  std::replace(name.begin(), name.end(), '_', '-');
  const auto row =
      std::find_if(table.begin(), table.end(), [&](const Row& o) { return o.name == name; });
  if (row == table.end()) {
    std::vector<std::string> names;
    for (const Row& o : table) names.emplace_back(o.name);
    std::string near = nearest_name(name, names);
    std::replace(near.begin(), near.end(), '-', '_');
    throw nb::type_error((std::string(verb) + ": no option '" + key + "'" +
                          (near.empty() ? "" : "; did you mean '" + near + "'?"))
                             .c_str());
  }
  std::visit(
      [&](const auto field) {
        auto& place = field(options);
        try {
          place = nb::cast<std::decay_t<decltype(place)>>(value);
        } catch (const nb::cast_error&) {
          throw nb::type_error((std::string(verb) + ": " + key + " cannot be " +
                                nb::cast<std::string>(nb::repr(value)))
                                   .c_str());
        }
      },
      row->field);
}

/// Binds the options of a verb as the class `name` with the method `set`, and their table as the
/// function `VERB_options`.
template <class T>
nb::class_<T> bind_options(nb::module_& m, const char* name, const std::string& verb,
                           std::span<const Option<T>> (*table)()) {
  m.def((verb + "_options").c_str(), [table] { return rows_of(table()); },
        nb::sig(("def " + verb + "_options() -> list[tuple[str, str, str, str, str]]").c_str()),
        "Returns the table of the options of a verb: name, type, default, unit and help.");
  nb::class_<T> c(m, name, ("The options of `" + verb + "`.").c_str());
  c.def(nb::init<>());
  c.def(
      "set",
      [verb, table](T& o, const std::string& option, nb::handle value) {
        set_option(verb, table(), o, option, value);
      },
      "name"_a, "value"_a, "Sets a row of the table of options.");
  return c;
}

}  // namespace underbrush::python
