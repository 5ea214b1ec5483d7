/// \file
/// A small HTTP server for one user on this machine.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "underbrush/serve/http_message.hpp"

namespace underbrush::serve {

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
