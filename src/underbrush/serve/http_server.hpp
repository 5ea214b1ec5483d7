/// \file
/// A small HTTP server for one user on this machine.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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
  double request_s = 5;       ///< From the first byte of a request to its last.
  double reply_s = 60;        ///< For sending a reply.
  double idle_s = 5;          ///< A connection without a request is closed.
  size_t requests = 1000;     ///< Requests on one connection.
};

/// Parses the value of a Range header with a single range "bytes=A-B" or "bytes=A-". Returns
/// nothing for any other text.
std::optional<ByteRange> byte_range_of(const std::string& header);

/// A server on the loopback interface. Its address holds a random token of 128 bits, without which
/// every request is refused; so are requests that name another host than this machine, which is how
/// a page of another origin would reach the server through a name that leads here, and POST
/// requests whose header Origin names another page than the server's own.
class HttpServer {
 public:
  using Handler = std::function<HttpReply(const HttpRequest&)>;

  /// Binds to 127.0.0.1. Port 0 takes a free one. Throws `IoError` where the port is taken.
  /// `handler` answers requests, on several threads at a time; what it throws becomes an answer
  /// with a status of 4xx or 5xx.
  HttpServer(int port, Handler handler, const HttpLimits& limits = {});
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  const std::string& token() const;
  /// The address with the token: http://127.0.0.1:PORT/TOKEN/.
  std::string address() const;
  /// Answers requests until `stop()`.
  void run();
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace underbrush::serve
