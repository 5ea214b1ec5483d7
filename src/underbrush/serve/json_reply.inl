// Replies that are JSON. Only sources of this module include this file.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "underbrush/serve/http_message.hpp"

namespace underbrush::serve {

using Json = nlohmann::ordered_json;

/// JSON as text; bytes that are not UTF-8 are replaced.
inline std::string text_of(const Json& j) {
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}
inline HttpReply reply_of(const Json& j, int status = 200) {
  return {status, "application/json", text_of(j)};
}
inline HttpReply error_reply(int status, const std::string& message) {
  return reply_of({{"error", message}}, status);
}

}  // namespace underbrush::serve
