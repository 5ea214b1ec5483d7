/// \file
/// The content of a list of edits as JSON.
#pragma once
#include "underbrush/io/json_text.inl"
#include "underbrush/serve/edit_list.hpp"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {

/// The content of a file of edits, none of which names another file: `text` itself, or with `text`
/// as its edits. Errors name it `place`.
inline Json edit_list(const std::string& text, const std::string& place) {
  const auto check = [&](bool ok, const std::string& what) {
    if (!ok) throw std::invalid_argument(place.empty() ? what : place + ": " + what);
  };
  std::optional<Json> given = text.empty() ? Json::array() : io::json_if_valid(text);
  if (given && given->is_array()) {
    given = {
        {"format", "underbrush-actor-edits"}, {"version", 1}, {"actors", "."}, {"edits", *given}};
  }
  check(given && given->is_object() && given->contains("format"), "not a list of edits of actors");
  size_t number = 0;
  for (const Json& edit : given->value("edits", Json::array())) {
    check(!edit.is_object() || !(edit.contains("trajectory") || edit.contains("model")),
          "edits[" + std::to_string(number++) + "] names a file, which edits on the page do not");
  }
  return *std::move(given);
}

}  // namespace underbrush::serve
