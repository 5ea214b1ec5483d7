/// \file
/// Requests and replies of the HTTP server, and its limits.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace underbrush::serve {

/// Bytes [first, first + count) of a file; `count` is empty up to its end.
struct ByteRange {
  uint64_t first = 0;
  std::optional<uint64_t> count;
};

/// A request that named the token: GET, or POST without a body, which changes something.
struct HttpRequest {
  std::string method = "GET";
  std::string path;  ///< Behind the token, without a slash at the start: "api/files".
  std::map<std::string, std::string> query;
  std::optional<ByteRange> range;
};

/// The answer to a request.
struct HttpReply {
  int status = 200;
  std::string type = "application/json";
  std::string body;
  /// Set for an answer to a range: its first byte and the length of the whole.
  std::optional<std::pair<uint64_t, uint64_t>> part_of = {};
};

/// Limits of the server.
struct HttpLimits {
  size_t workers = 24;        ///< Connections that are answered at the same time.
  size_t waiting = 48;        ///< Further connections that wait; more are closed at once.
  size_t head_bytes = 16384;  ///< Longest request; there are no bodies.
  double request_s = 5;       ///< Longest time from the first byte of a request to its last.
  double reply_s = 60;        ///< Longest time for sending a reply.
  double idle_s = 5;          ///< Time after which a connection without a request is closed.
  size_t requests = 1000;     ///< Requests on one connection.
};

}  // namespace underbrush::serve
